#pragma once

#include <functional>
#include <optional>
#include <string>

#include <accdec/program/plan/design_program.hpp>
#include <accdec/program/read/toolpath.hpp>
#include <accdec/program/write/program_report.hpp>
#include <accdec/task/task.hpp>

namespace accdec {

/// How a program file is read and planned; what is not said here follows from the task and the feeds.
struct ProgramFileOptions {
  double arc_tolerance = 2e-6;  ///< m, largest distance of a chord from its arc
  std::string tool_table;       ///< LinuxCNC's, for programs that rs274 has to run; may be empty
  bool rapid_stops = false, dwells_before_filter = false;  ///< see ToolpathOptions
  Feeds feeds = Feeds::choose;
  bool per_leg = false, filter_bound = false;  ///< see run_program
  std::optional<double> time_limit;  ///< s, for the design of a filter; none: 2 s and 5 ms a block, at most 60
};

/// The toolpath by our own reader, or where only an interpreter of the whole language understands the program, through
/// rs274.
/// @param tell  told in words what a user should know of that; may be empty
/// @throws ReadError, std::invalid_argument as the readers do
Toolpath read_program_file(const std::string& file, const Task& task, const ProgramFileOptions& options,
                           const std::function<void(const std::string&)>& tell);

/// The task's filter, or one designed for the program; none where none holds, for the reason in the message.
/// @param tell  one line a step, may be empty
ProgramFilter filter_for_program(const Toolpath& path, const Task& task, const ProgramFileOptions& options,
                                 const std::function<void(const std::string&)>& tell);

/// Reads, chooses the filter, plans and verifies: `accdec program`. Where no filter holds, a failed result that says
/// why.
ProgramResult run_program_file(const std::string& file, const Task& task, const ProgramFileOptions& options,
                               const std::function<void(const std::string&)>& tell);

}  // namespace accdec
