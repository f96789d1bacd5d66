#pragma once

#include <functional>
#include <optional>
#include <string>

#include <accdec/program/plan/design_program_filter.hpp>
#include <accdec/program/read/toolpath.hpp>
#include <accdec/program/write/program_report.hpp>
#include <accdec/task/task.hpp>

namespace accdec {

/// How a program file is read and planned; what is not said here follows from the task and the feeds.
struct ProgramFileOptions {
  std::optional<double> arc_tolerance;  ///< m, largest distance of a chord from its arc; none: chord_tolerance, 2 um
                                        ///< where feeds are kept, which does not see accelerations along an arc
  bool compensate_arcs = false;         ///< the commanded radius is widened, see compensate_arcs
  std::string tool_table;               ///< LinuxCNC's, for programs that rs274 has to run; may be empty
  bool rapid_stops = false, dwells_before_filter = false;  ///< see ToolpathOptions
  Feeds feeds = Feeds::choose;
  bool per_leg = false, filter_bound = false;  ///< see run_program
  std::optional<double> time_limit;  ///< s, for the design of a filter; none: 2 s and 5 ms a block, at most 60
};

/// A program as it was read.
struct ProgramFile {
  Toolpath path;
  ToolpathOptions reading;
  bool interpreted = false;  ///< by rs274: lines are those of its output
};

/// How far chords may be from their arcs so that planning them is planning the arc, m: the sagitta a T^2/8 of what an
/// arc's fastest motion, v = sqrt(a R), passes in a sample, whatever the radius, a the least acceleration limit of an
/// axis. Longer chords turn the velocity in larger steps than the arc does from sample to sample, which the limits have
/// to leave room for. At most 2 um, where there is no limit, too; at least 0.1 um.
double chord_tolerance(const Task& task);

/// The toolpath by our own reader, or where only an interpreter of the whole language understands the program, through
/// rs274.
/// @param tell  told in words what a user should know of that; may be empty
/// @throws ReadError, std::invalid_argument as the readers do
ProgramFile read_program_file(const std::string& file, const Task& task, const ProgramFileOptions& options,
                              const std::function<void(const std::string&)>& tell);

/// The task's filter, that of a program which --emit wrote and is read as such, or one designed for the program; none
/// where none holds, for the reason in the message.
/// @param tell  one line a step, may be empty
ProgramFilter filter_for_program(const Toolpath& path, const Task& task, const ProgramFileOptions& options,
                                 const std::function<void(const std::string&)>& tell);

/// Plans and verifies what was read. Where arcs were read in chords finer than feeds kept ask for (see
/// ProgramFileOptions), the program is read in those, too, and the faster of both plans is the answer: of long filters
/// fine chords are no better, and what keeps feeds needs the longer ones.
/// @param file  its path is taken; its `reading` becomes that of the answer
ProgramResult plan_program_file(const std::string& name, ProgramFile& file, const ProgramFilter& choice,
                                const Task& task, const ProgramFileOptions& options);

/// Chooses the filter, plans and verifies what was read. Where no filter holds, a failed result that says why.
/// @param file  as of plan_program_file
/// @param tell  as of filter_for_program
ProgramResult run_program_file(const std::string& name, ProgramFile& file, const Task& task,
                               const ProgramFileOptions& options, const std::function<void(const std::string&)>& tell);

}  // namespace accdec
