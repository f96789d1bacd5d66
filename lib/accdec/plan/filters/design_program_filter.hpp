#pragma once

#include <functional>
#include <optional>
#include <string>

#include <accdec/files.hpp>
#include <accdec/filter.hpp>
#include <accdec/program.hpp>
#include <accdec/result.hpp>
#include <accdec/task.hpp>

namespace accdec {

/// The filter for a program whose task leaves it open. Candidates are designed for the representative task, by
/// `design_task` and among the standard shapes. A search over trapezoids judges each by the whole program. The result
/// is the candidate with the shortest time of the whole program, with exact delays of every corner.
struct ProgramFilter {
  std::optional<Filter> filter;             ///< none when no candidate holds the limits; the reason is in the message
  std::optional<ProgramSettings> settings;  ///< of a control, which these are
  SolverReport solver;
  std::string message;
  bool designed = false;  ///< for this program, not given
  KnownPlan plan;         ///< by which it was chosen, if that was simulated and held
};
/// @param time_limit  s, for the design by `design_task`  @param progress  one line a step, may be empty
/// @param deadline    of the whole command: ends the comparison of designs by their plans
ProgramFilter design_program_filter(const Toolpath& path, const Task& task, double time_limit,
                                    const std::function<void(const std::string&)>& progress,
                                    const Deadline& deadline = {});

/// The filter for a program whose feeds are chosen. It is the best trapezoid. If none holds, or if vibration bounds,
/// force, power or a jerk limit alone may favour other taps, the filter of design_program_filter is tried too. It is
/// taken if it is faster by a plan of the program.
/// @param time_limit  s; a fraction of it for the search
/// @param deadline    as of design_program_filter
ProgramFilter design_filter_for_feeds(const Toolpath& path, const Task& task, double time_limit,
                                      const std::function<void(const std::string&)>& progress,
                                      const Deadline& deadline = {});

}  // namespace accdec
