#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <utility>

#include <accdec/files/file_kind.hpp>
#include <accdec/files/text_file.hpp>
#include <accdec/program/read/read_error.hpp>
#include <accdec/program/read/run_rs274.hpp>
#include <accdec/program/write/emitted_filters.hpp>
#include <accdec/program/write/program_file.hpp>

namespace accdec {
namespace {

constexpr double longest_chords = 2e-6;  // m from their arcs

/// Says what a file seems to be that is no program; does nothing where it may be one.
void refuse_other_kinds(const std::string& file) {
  if (!std::filesystem::is_regular_file(file)) return;
  if (const std::string wrong = wrong_kind(read_text_file(file), InputKind::program); !wrong.empty())
    throw std::invalid_argument(file + ": " + wrong);
}

}  // namespace

double chord_tolerance(const Task& task) {
  constexpr double least = 1e-7;
  double acceleration = unlimited;
  for (const Axis& axis : task.machine.axes) acceleration = std::min(acceleration, axis.acceleration_max);
  if (!(acceleration < unlimited)) return longest_chords;
  return std::clamp(acceleration * task.sample_period * task.sample_period / 8.0, least, longest_chords);
}

ProgramFile read_program_file(const std::string& file, const Task& task, const ProgramFileOptions& options,
                              const std::function<void(const std::string&)>& tell) {
  ProgramFile result;
  ToolpathOptions& reading = result.reading;
  reading.read.arc_tolerance =
      options.arc_tolerance.value_or(options.feeds == Feeds::choose ? chord_tolerance(task) : longest_chords);
  reading.widen_arcs = options.compensate_arcs;
  reading.error_max = task.program_error_max;
  reading.clamp_feeds = options.feeds == Feeds::choose;
  reading.rapid_stops = options.rapid_stops;
  reading.dwells_before_filter = options.dwells_before_filter;
  try {
    LineSource source{std::filesystem::path(file)};
    result.path = read_toolpath(source, task.machine, reading);
    if (source.byte_order_mark() && tell) tell(file + ": begins with a byte order mark, which is passed over");
    return result;
  } catch (const NeedsInterpreter& reason) {
    refuse_other_kinds(file);
    std::string calls;
    try {
      calls = interpreted(file, options.tool_table);
    } catch (const std::invalid_argument& refused) {
      throw std::invalid_argument(std::string(reason.what()) + "\n" + refused.what());
    }
    if (tell)
      tell(std::string(reason.what()) +
           ": run by rs274; lines are those of its output, which has no comments, N words and %");
    LineSource source(file + " (rs274 -g)", calls);
    result.path = read_toolpath(source, task.machine, reading);
    result.interpreted = true;
    return result;
  } catch (const ReadError&) {
    refuse_other_kinds(file);
    throw;
  }
}

ProgramFilter filter_for_program(const Toolpath& path, const Task& task, const ProgramFileOptions& options,
                                 const std::function<void(const std::string&)>& tell) {
  if (task.filter) {
    ProgramFilter given;
    given.filter = make_filter(*task.filter);
    given.solver.method = "given";
    return given;
  }
  if (const auto emitted = options.dwells_before_filter ? emitted_filter(path) : std::nullopt) {
    if (tell) tell("the filter is the one that the program was planned for");
    ProgramFilter given;
    given.filter = *emitted;
    given.solver.method = "given by the program";
    return given;
  }
  // Small programs are not worth a minute.
  const double limit = options.time_limit.value_or(std::min(60.0, 2.0 + 5e-3 * static_cast<double>(path.blocks())));
  return options.feeds == Feeds::keep ? design_program_filter(path, task, limit, tell)
                                      : design_filter_for_feeds(path, task, limit, tell);
}

ProgramResult plan_program_file(const std::string& name, ProgramFile& file, const ProgramFilter& choice,
                                const Task& task, const ProgramFileOptions& options) {
  const bool finer = options.feeds == Feeds::choose && !options.arc_tolerance && !file.path.arcs.empty() &&
                     file.path.blocks() <= several_plans_max && file.reading.read.arc_tolerance < longest_chords;
  const auto plan = [&](Toolpath path, Feeds feeds) {
    return run_program(name, std::move(path), *choice.filter, task, options.per_leg, options.filter_bound, feeds);
  };
  ProgramResult result = plan(std::move(file.path), finer ? Feeds::choose_only : options.feeds);
  double planning = result.solver.wall_time;
  if (finer) {
    ProgramFileOptions coarse = options;
    coarse.arc_tolerance = longest_chords;
    ProgramFile again = read_program_file(name, task, coarse, {});
    ProgramResult other = plan(std::move(again.path), options.feeds);
    planning += other.solver.wall_time;
    const bool as_asked = !options.compensate_arcs || !other.path.programmed.empty() || result.path.programmed.empty();
    const bool better = other.verification.feasible && as_asked &&
                        (!result.verification.feasible || other.cycle_time < result.cycle_time);
    if (!result.cycle_time_kept) result.cycle_time_kept = other.cycle_time_kept;
    if (better) {
      result = std::move(other);
      file.reading = again.reading;
    }
  }
  result.solver = choice.solver;
  result.solver.wall_time += planning;
  return result;
}

ProgramResult run_program_file(const std::string& name, ProgramFile& file, const Task& task,
                               const ProgramFileOptions& options, const std::function<void(const std::string&)>& tell) {
  const ProgramFilter choice = filter_for_program(file.path, task, options, tell);
  if (!choice.filter) {
    ProgramResult none;
    none.program = name;
    none.sample_period = task.sample_period;
    none.message = choice.message;
    none.solver = choice.solver;
    return none;
  }
  return plan_program_file(name, file, choice, task, options);
}

}  // namespace accdec
