#pragma once

#include <functional>
#include <optional>
#include <string>

#include <accdec/program/read/toolpath.hpp>
#include <accdec/task/result.hpp>
#include <accdec/task/task.hpp>

namespace accdec {

/// The filter for a program whose task leaves it open. Candidates are designed for the representative task (by
/// `design_task` and among the standard shapes), and a search over trapezoids judges each by the whole program; the one
/// with the shortest time of the whole program, with exact delays of every corner, is taken.
struct ProgramFilter {
  std::optional<Filter> filter;  ///< none when no candidate holds the limits; the reason is in the message
  SolverReport solver;
  std::string message;
};
/// @param time_limit  s, for the design by `design_task`  @param progress  one line a step, may be empty
ProgramFilter design_program_filter(const Toolpath& path, const Task& task, double time_limit,
                                    const std::function<void(const std::string&)>& progress);

/// The filter for a program whose feeds are chosen: the best trapezoid by search_filter; where none holds, or where
/// vibration bounds, force or power may favour other taps, that of design_program_filter, if it is faster by a schedule
/// of the program.
/// @param time_limit  s; a fraction of it for the search
ProgramFilter design_filter_for_feeds(const Toolpath& path, const Task& task, double time_limit,
                                      const std::function<void(const std::string&)>& progress);

}  // namespace accdec
