#pragma once

#include <functional>
#include <string>
#include <vector>

#include <accdec/task/task.hpp>

namespace accdec {

/// A set of limits of the task that cannot be held together although any of them left out could be, given a predicate
/// that says whether a task has a design: every limit is left out once, and stays out if that changes nothing. An
/// axis limit is named with its axis ("jerk y"), corner errors and smallest speeds with their corner, vibration with
/// its frequencies. Only as reliable as the predicate. Empty when the task with no limits at all still has no design.
std::vector<std::string> limits_in_conflict(const Task& task, const std::function<bool(const Task&)>& has_design);

}  // namespace accdec
