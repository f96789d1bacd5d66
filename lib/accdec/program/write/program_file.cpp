#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <utility>

#include <accdec/program/read/interpreter.hpp>
#include <accdec/program/read/read_error.hpp>
#include <accdec/program/write/program_file.hpp>

namespace accdec {

Toolpath read_program_file(const std::string& file, const Task& task, const ProgramFileOptions& options,
                           const std::function<void(const std::string&)>& tell) {
  ToolpathOptions reading;
  reading.read.arc_tolerance = options.arc_tolerance;
  reading.error_max = task.program_error_max;
  reading.clamp_feeds = options.feeds == Feeds::choose;
  reading.rapid_stops = options.rapid_stops;
  reading.dwells_before_filter = options.dwells_before_filter;
  try {
    LineSource source{std::filesystem::path(file)};
    Toolpath path = read_toolpath(source, task.machine, reading);
    if (source.byte_order_mark() && tell) tell(file + ": begins with a byte order mark, which is passed over");
    return path;
  } catch (const NeedsInterpreter& reason) {
    std::string calls;
    try {
      calls = interpreted(file, options.tool_table);
    } catch (const std::invalid_argument& refused) {
      throw std::invalid_argument(std::string(reason.what()) + "\n" + refused.what());
    }
    if (tell) tell(std::string(reason.what()) + ": run by rs274; lines are those of its output");
    LineSource source(file + " (rs274 -g)", calls);
    return read_toolpath(source, task.machine, reading);
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
  // Small programs are not worth a minute.
  const double limit = options.time_limit.value_or(std::min(60.0, 2.0 + 5e-3 * static_cast<double>(path.blocks())));
  return options.feeds == Feeds::keep ? design_program_filter(path, task, limit, tell)
                                      : design_filter_for_feeds(path, task, limit, tell);
}

ProgramResult run_program_file(const std::string& file, const Task& task, const ProgramFileOptions& options,
                               const std::function<void(const std::string&)>& tell) {
  Toolpath path = read_program_file(file, task, options, tell);
  const ProgramFilter choice = filter_for_program(path, task, options, tell);
  if (!choice.filter) {
    ProgramResult none;
    none.program = file;
    none.sample_period = task.sample_period;
    none.message = choice.message;
    none.solver = choice.solver;
    return none;
  }
  ProgramResult result =
      run_program(file, std::move(path), *choice.filter, task, options.per_leg, options.filter_bound, options.feeds);
  const double planning = result.solver.wall_time;
  result.solver = choice.solver;
  result.solver.wall_time += planning;
  return result;
}

}  // namespace accdec
