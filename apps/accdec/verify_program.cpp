#include "verify_program.hpp"

#include <cstdio>
#include <filesystem>
#include <vector>

#include <fmt/format.h>

#include <accdec/formats/program_record.hpp>
#include <accdec/program/read/read_error.hpp>
#include <accdec/program/simulate/direct.hpp>
#include <accdec/program/write/verify_program_result.hpp>

namespace accdec::cli {
namespace {

constexpr double steps_a_second = 2e8;  // of direct_motion on one core of 2.6 GHz, long double

/// Holds the commands against the program. @param note  receives what was done, or why nothing was
std::string departure(const ProgramRecord& record, std::string& note) {
  const ProgramInputs& in = record.inputs;
  if (in.interpreted) {
    note = "the program was run by rs274 and is not read again: points, tolerances and feeds are those recorded";
    return "";
  }
  if (!std::filesystem::is_regular_file(in.program)) {
    note = fmt::format("{} is not there: points, tolerances and feeds are those recorded", in.program);
    return "";
  }
  if (hash_of_file(in.program) != in.program_hash) {
    note = fmt::format("{} has changed since: points, tolerances and feeds are those recorded", in.program);
    return "";
  }
  LineSource source{std::filesystem::path(in.program)};
  const Toolpath programmed = read_toolpath(source, record.task.machine, in.reading);
  note = fmt::format(
      "{} read again: every programmed point in order, no feed above and no tolerance wider than its own", in.program);
  return departs_from(record.result.path, programmed);
}

}  // namespace

void verify_program(const std::string& text, const std::string& path, double limit, Context& context) {
  const ProgramRecord record = parse_program_record(text, path);
  const auto refuse = [&](const std::string& reason) {
    context.exit_code = exit_no_answer;
    if (!context.quiet) fmt::print("rejected\n  {}\n", reason);
  };
  if (!record.commands) {
    return refuse(fmt::format(
        "the result holds no commands to simulate anew (accdec keeps them up to {} blocks): run accdec program again, "
        "which verifies what it plans",
        recorded_blocks_max));
  }
  const ProgramResult& result = record.result;
  if (result.status != Status::feasible) return refuse("the result is failed: there is no plan to verify");
  const double seconds =
      direct_motion_steps(result.path, result.sample_period, result.plan.delays, result.legs) / steps_a_second;
  if (seconds > limit)
    return refuse(
        fmt::format("simulating the plan anew would take about {:.0f} s; --time-limit is {:g} s", seconds, limit));
  ProgramResultCheck check = verify_program_result(result, record.task);
  std::string note;
  if (const std::string wrong = departure(record, note); !wrong.empty())
    check.reasons.push_back(fmt::format("the commands are not those of {}: {}", record.inputs.program, wrong));
  if (!check.reasons.empty()) {
    refuse(fmt::format("{}", check.reasons.front()));
    for (std::size_t i = 1; i < check.reasons.size() && !context.quiet; ++i) fmt::print("  {}\n", check.reasons[i]);
    return;
  }
  if (!context.quiet) fmt::print("accepted: {}\n{}\n", check.shown, note);
}

}  // namespace accdec::cli
