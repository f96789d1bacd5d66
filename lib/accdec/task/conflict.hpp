#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include <accdec/task.hpp>

namespace accdec {

/// The names of corner errors and given delays as limits begin so; the corner's name follows.
inline constexpr std::string_view error_in_conflict = "corner error ", delay_in_conflict = "delay of corner ";

/// A set of limits of the task that cannot be held together, although all others can be held if any one of them is left
/// out. It uses a predicate that tells whether a task has a design. Every limit is left out once, and stays out if that
/// changes nothing. Corner errors and smallest speeds are named with their corner, vibration with its frequencies. The
/// answer is as reliable as the predicate. Empty when the task with no limits at all still has no design.
/// @param each_axis  axis limits are left out and named one by one ("jerk y"); else all of a kind together ("jerk")
std::vector<std::string> limits_in_conflict(const Task& task, bool each_axis,
                                            const std::function<bool(const Task&)>& has_design);

}  // namespace accdec
