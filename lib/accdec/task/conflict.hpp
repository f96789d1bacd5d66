#pragma once

#include <functional>
#include <string>
#include <vector>

#include <accdec/task/task.hpp>

namespace accdec {

/// A set of limits of the task that cannot be held together although any of them left out could be, given a predicate
/// that says whether a task has a design: every limit is left out once, and stays out if that changes nothing. Corner
/// errors and smallest speeds are named with their corner, vibration with its frequencies. Only as reliable as the
/// predicate. Empty when the task with no limits at all still has no design.
/// @param each_axis  axis limits are left out and named one by one ("jerk y"); else all of a kind together ("jerk")
std::vector<std::string> limits_in_conflict(const Task& task, bool each_axis,
                                            const std::function<bool(const Task&)>& has_design);

}  // namespace accdec
