#include "verify_program.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include <accdec/files.hpp>
#include <accdec/files/shown_text.hpp>
#include <accdec/files/text_file.hpp>
#include <accdec/gcode/read_error.hpp>
#include <accdec/gcode/run_rs274.hpp>
#include <accdec/machine/position_unit.hpp>
#include <accdec/plan/record/check_record.hpp>
#include <accdec/plan/record/program_record.hpp>
#include <accdec/plan/report/left_at_rest.hpp>
#include <accdec/plan/report/plan_facts.hpp>
#include <accdec/simulate.hpp>
#include <accdec/simulate/direct.hpp>
#include <accdec/simulate/profile_motion.hpp>

#include "time_limit.hpp"

namespace accdec::cli {
namespace {

constexpr double blocks_a_second = 1e4;   // planned with profiles; the slowest measured, a relief under a jerk limit
constexpr double samples_a_second = 5e6;  // of a trajectory, made and checked
constexpr double steps_a_second = 2e8;    // of direct_motion on one core of 2.6 GHz, long double

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
    ToolpathOptions reading = in.reading;
    reading.read.tools = in.tools.given();
    Toolpath programmed = read_toolpath(source, record.task.machine, reading);
    if (in.interpreted) reasons.push_back("inputs.interpreted is recorded, but accdec reads the program itself");
    return programmed;
  } catch (const NeedsInterpreter& reason) {
    if (!in.interpreted) {
      reasons.push_back(fmt::format("inputs.interpreted is recorded as false, but {}", reason.what()));
      return std::nullopt;
    }
  }
  try {
    return read_interpreted(in.program, in.tools, record.task.machine, in.reading);
  } catch (const ReadError&) {
    throw;
  } catch (const std::invalid_argument&) {
    return std::nullopt;
  }
}

namespace {

/// About, of making the motion of a record's plan.
double motion_seconds(const ProgramRecord& record) {
  const ProgramResult& result = record.result;
  const Toolpath& path = result.plan.path;
  if (const FilteredCommand* command = result.plan.command()) {
    const BlockFilters filters = record.filters.value_or(BlockFilters{{command->filter}, {}});
    return direct_motion_steps(path, result.sample_period, command->delays, filters) / steps_a_second;
  }
  const Trajectory& trajectory = *result.plan.trajectory();
  if (trajectory.is_free()) return static_cast<double>(trajectory.free.block.size()) / samples_a_second;
  constexpr double rest_seen = 1e4;  // samples
  double time = std::min(path.dwell_first, rest_seen * result.sample_period) + chain_time(trajectory.chain);
  // Long rests are passed over.
  for (const auto& [block, dwell] : path.dwell) time += std::min(dwell, rest_seen * result.sample_period);
  const double rests = static_cast<double>(path.blocks()) * (trajectory.last.order() + 1.0);  // at most
  return (time / result.sample_period + rests) / samples_a_second;
}

void rejected(const std::string& reason, Context& context) {
  context.exit_code = exit_no_answer;
  if (!context.quiet) fmt::print("rejected\n  {}\n", printable(reason));
}

/// Says why neither acceptance nor rejection is possible.
void not_checked(const std::string& path, const std::string& reason, Context& context) {
  context.exit_code = exit_no_answer;
  fmt::print(stderr, "{}: not checked: {}\n", printable(path), printable(reason));
}

void print_accepted(const ProgramRecord& record, const RecordCheck& check, bool read) {
  const bool bounds = std::find(check.skipped.begin(), check.skipped.end(), "bounds") != check.skipped.end();
  const bool proved = check.proved_bound > 0.0;
  fmt::print("accepted: {}{}\n", printable(check.shown), bounds && !proved ? "; bounds were not recomputed" : "");
  if (proved)
    fmt::print("bound accepted: multipliers prove that any motion takes {:.6g} s or more; the result says {:.6g} s\n",
               check.proved_bound, record.result.corner_bound->any_motion);
  for (const std::string& left_out : left_out_by_residuals(record.result)) fmt::print("{}\n", left_out);
  for (const std::string& left : left_at_rest_in_words(record.result, left_at_rest(record.result)))
    fmt::print("{}\n", left);
  if (const double unit = record.task.machine.position_unit; unit > 0.0)
    fmt::print("corner errors do not count the rounding of positions, by up to {:.4g} position units\n",
               unit_rounding(record.task.machine, record.result.plan.path.dimensions()) / unit);
  if (read) {
    fmt::print("{} read again: the plan passes its points in order, within its feeds and with its tolerances\n",
               printable(record.inputs.program));
  } else {
    fmt::print(
        "the program was run by rs274, which is not installed, so it is not read again: points, tolerances and feeds "
        "are those recorded\n");
  }
  if (!std::filesystem::is_regular_file(record.inputs.task_path))
    fmt::print("{} is not there: the task is the one in the result\n", printable(record.inputs.task_path));
  const bool searched =
      std::find(check.skipped.begin(), check.skipped.end(), "settings.complete") != check.skipped.end();
  fmt::print("not checked, because they say how the plan was found or what others take: {}{}, inputs.compensate_arcs\n",
             fmt::join(check.skipped, ", "),
             searched ? ", the words of settings.answer on how far the settings were searched" : "");
}

}  // namespace

void verify_program(const std::string& text, const std::string& path, double limit, double spent, Context& context) {
  const auto began = std::chrono::steady_clock::now();
  const ProgramRecord record = parse_program_record(text, path);
  const auto refuse = [&](const std::string& reason) { rejected(reason, context); };
  const bool plan_again = record.schema == ProgramSchema::profiles_1;
  const auto pass = [&](const std::string& reason) { not_checked(path, reason, context); };
  if (!record.commands && !plan_again) {
    return pass(
        fmt::format("the result holds no commands to simulate again, because only those of up to {} moves are kept; "
                    "accdec program verifies every plan that it prints",
                    recorded_blocks_max));
  }
  const ProgramResult& result = record.result;
  if (result.status != Status::feasible) return refuse("the result is failed: there is no plan to verify");
  if (const double seconds = plan_again ? 0.0 : motion_seconds(record); !(seconds <= limit))
    return pass(fmt::format("simulating the plan again would take about {} s; --time-limit is {:g} s",
                            shown_above(seconds, limit), limit));
  // How long the rest takes is only estimated.
  const TimeLimit ends(
      limit - spent - seconds_since(began),
      fmt::format("{}: not checked: checking the plan takes longer than --time-limit {:g} s", printable(path), limit),
      exit_no_answer);
  if (const std::string why = changed_inputs(record.inputs); !why.empty())
    return std::filesystem::is_regular_file(record.inputs.program) ? refuse(why) : pass(why);
  std::vector<std::string> reasons;
  std::optional<Toolpath> programmed = read_again(record, reasons);
  const bool read = programmed.has_value();
  const double seconds = plan_again && read ? static_cast<double>(programmed->blocks()) / blocks_a_second : 0.0;
  if (seconds > limit)
    return pass(fmt::format("planning {} moves again may take {} s; --time-limit is {:g} s", programmed->blocks(),
                            shown_above(seconds, limit), limit));
  // Planning again leaves the time for all else.
  const Deadline today(0.5 * (limit - spent - seconds_since(began)));
  RecordCheck check = check_program_record(text, record, std::move(programmed), today);
  check.reasons.insert(check.reasons.begin(), reasons.begin(), reasons.end());
  if (!check.reasons.empty()) return refuse(fmt::format("{}", fmt::join(check.reasons, "\n  ")));
  if (!context.quiet) print_accepted(record, check, read);
}

}  // namespace accdec::cli
