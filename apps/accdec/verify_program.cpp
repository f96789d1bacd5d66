#include "verify_program.hpp"

#include <cstdio>
#include <filesystem>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include <accdec/files/text_file.hpp>
#include <accdec/formats/program_comparison.hpp>
#include <accdec/formats/program_record.hpp>
#include <accdec/program/plan/filter_bound.hpp>
#include <accdec/program/plan/lower_bound.hpp>
#include <accdec/program/plan/program_plan.hpp>
#include <accdec/program/read/read_error.hpp>
#include <accdec/program/read/run_rs274.hpp>
#include <accdec/program/simulate/direct.hpp>
#include <accdec/program/write/fastest_plan.hpp>
#include <accdec/program/write/program_departure.hpp>
#include <accdec/program/write/verify_program_result.hpp>

namespace accdec::cli {
namespace {

constexpr double blocks_a_second = 1e4;  // planned with profiles; the slowest measured, a relief under a jerk limit
constexpr double steps_a_second = 2e8;   // of direct_motion on one core of 2.6 GHz, long double

}  // namespace

std::string changed_inputs(const ProgramInputs& in) {
  const auto there = [](const std::string& path) { return std::filesystem::is_regular_file(path); };
  if (!there(in.program))
    return fmt::format("{} is not there: without the program its points, tolerances and feeds cannot be checked",
                       in.program);
  if (hash_of_file(in.program) != in.program_hash)
    return fmt::format("{} has changed since: the result is of another program", in.program);
  if (there(in.task_path) && read_text_file(in.task_path) != in.task_text)
    return fmt::format("{} has changed since: the result is of another task", in.task_path);
  return "";
}

std::optional<Toolpath> read_again(const ProgramRecord& record, std::vector<std::string>& reasons) {
  const ProgramInputs& in = record.inputs;
  try {
    LineSource source{std::filesystem::path(in.program)};
    Toolpath programmed = read_toolpath(source, record.task.machine, in.reading);
    if (in.interpreted) reasons.push_back("inputs.interpreted is recorded, but accdec reads the program itself");
    return programmed;
  } catch (const NeedsInterpreter& reason) {
    if (!in.interpreted) {
      reasons.push_back(fmt::format("inputs.interpreted is recorded as false, but {}", reason.what()));
      return std::nullopt;
    }
  }
  std::string calls;
  try {
    calls = interpreted(in.program, in.tool_table);
  } catch (const std::invalid_argument&) {
    return std::nullopt;
  }
  LineSource source(in.program + " (rs274 -g)", calls);
  return read_toolpath(source, record.task.machine, in.reading);
}

namespace {

/// Holds the commands against the program, and makes what is recorded of it anew.
void compare_with_program(const ProgramRecord& record, Toolpath programmed, ProgramResultCheck& check) {
  const ProgramInputs& in = record.inputs;
  if (const std::string wrong = departs_from(record.result.path, programmed); !wrong.empty())
    check.reasons.push_back(fmt::format("the commands are not those of {}: {}", in.program, wrong));
  ProgramResult& found = check.found;
  found.programmed_blocks = programmed.blocks();
  found.feeds_chosen = record.result.feeds_chosen;
  const bool stepped = found.path.blocks() != programmed.blocks();
  if (found.feeds_chosen ? !in.reading.clamp_feeds : stepped)
    check.reasons.push_back("feeds are recorded as what the commands are not");
  found.path.clamped = programmed.clamped;
  const Machine machine = program_machine(record.task.machine, programmed);
  snap_durations(programmed, found.filter, found.sample_period, machine);
  found.lower_bound = program_lower_bound(programmed, machine, found.sample_period);
  if (record.filter_bound) found.filter_bound = filter_lower_bound(programmed, machine, found.sample_period);
}

/// Of programs that rs274 ran, whose output is not kept.
const std::vector<std::string> of_the_program{"blocks", "feeds", "feeds_clamped", "lower_bound_s", "filter_bound_s"};

void rejected(const std::string& reason, Context& context) {
  context.exit_code = exit_no_answer;
  if (!context.quiet) fmt::print("rejected\n  {}\n", reason);
}

void print_accepted(const ProgramRecord& record, const std::string& shown, bool read,
                    const std::vector<std::string>& open) {
  fmt::print("accepted: {}\n", shown);
  if (read) {
    fmt::print("{} read again: every programmed point in order, no feed above and no tolerance other than its own\n",
               record.inputs.program);
  } else {
    fmt::print(
        "the program was run by rs274, which is not here, and is not read again: points, tolerances and feeds are "
        "those recorded\n");
  }
  if (!std::filesystem::is_regular_file(record.inputs.task_path))
    fmt::print("{} is not there: the task is the one in the result\n", record.inputs.task_path);
  fmt::print("not checked, because they say how the plan was found or what others take: {}, inputs.compensate_arcs\n",
             fmt::join(open, ", "));
}

}  // namespace

void verify_profiles(const std::string& text, const std::string& path, double limit, Context& context) {
  const ProgramRecord record = parse_profile_record(text, path);
  const auto refuse = [&](const std::string& reason) { rejected(reason, context); };
  if (record.result.status != Status::feasible) return refuse("the result is failed: there is no plan to verify");
  if (const std::string why = changed_inputs(record.inputs); !why.empty()) return refuse(why);
  std::vector<std::string> reasons;
  std::optional<Toolpath> programmed = read_again(record, reasons);
  if (!programmed) reasons.push_back("the program was run by rs274, which is not here: it cannot be planned anew");
  if (record.result.program != record.inputs.program)
    reasons.push_back(
        fmt::format("program is recorded as {}, inputs.program as {}", record.result.program, record.inputs.program));
  if (!reasons.empty()) return refuse(fmt::format("{}", fmt::join(reasons, "\n  ")));
  const double seconds = static_cast<double>(programmed->blocks()) / blocks_a_second;
  if (seconds > limit)
    return refuse(fmt::format("planning {} blocks anew may take {:.0f} s; --time-limit is {:g} s", programmed->blocks(),
                              seconds, limit));
  const ProfileResult found = plan_profiles_of(record.inputs.program, std::move(*programmed),
                                               record.inputs.reading.read.arc_tolerance, record.task);
  const ProgramDifferences compared = profile_differences(text, found);
  if (!compared.reasons.empty()) return refuse(fmt::format("{}", fmt::join(compared.reasons, "\n  ")));
  if (context.quiet) return;
  fmt::print("accepted: planned anew from {} and the task, {} samples, {:.6g} s: all bounds hold\n",
             record.inputs.program, found.plan.check.samples, found.cycle_time);
  fmt::print("not checked: {}\n", fmt::join(compared.skipped, ", "));
}

void verify_program(const std::string& text, const std::string& path, double limit, Context& context) {
  const ProgramRecord record = parse_program_record(text, path);
  const auto refuse = [&](const std::string& reason) { rejected(reason, context); };
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
  if (const std::string why = changed_inputs(record.inputs); !why.empty()) return refuse(why);
  ProgramResultCheck check = verify_program_result(result, record.task);
  if (result.program != record.inputs.program)
    check.reasons.push_back(
        fmt::format("program is recorded as {}, inputs.program as {}", result.program, record.inputs.program));
  std::optional<Toolpath> programmed = read_again(record, check.reasons);
  const bool read = programmed.has_value();
  if (read) compare_with_program(record, std::move(*programmed), check);
  check.found.worst_shown = result.worst_shown;
  const ProgramDifferences compared =
      program_differences(text, check.found, read ? std::vector<std::string>{} : of_the_program);
  check.reasons.insert(check.reasons.end(), compared.reasons.begin(), compared.reasons.end());
  if (!check.reasons.empty()) return refuse(fmt::format("{}", fmt::join(check.reasons, "\n  ")));
  if (!context.quiet) print_accepted(record, check.shown, read, compared.skipped);
}

}  // namespace accdec::cli
