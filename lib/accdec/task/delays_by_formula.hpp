#pragma once

#include <functional>
#include <optional>
#include <vector>

#include <accdec/task/task.hpp>

namespace accdec {

/// For each corner the smallest delay at which its error bound and all limits hold with this filter, given delays kept;
/// nothing when they do not exist or the task's objective (objective.hpp) is not below `samples` (in sample periods). A
/// quick choice by formula, with nine tenths of the verification's tolerance as slack: whoever uses it verifies by
/// simulation. O(axes (N + d)) a delay that holds, less for most that do not.
/// @param task  its own filter, if any, is ignored
/// @param stop  asked before every delay: nothing when it says so
std::optional<std::vector<int>> delays_by_formula(const Filter& filter, const Task& task, double samples,
                                                  const std::function<bool()>& stop = {});

}  // namespace accdec
