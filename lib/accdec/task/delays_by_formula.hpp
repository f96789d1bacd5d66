#pragma once

#include <functional>
#include <optional>
#include <vector>

#include <accdec/task.hpp>

namespace accdec {

/// For each corner, the smallest delay at which its error bound and all limits hold with this filter; given delays are
/// kept. Empty if there is none, or if the task's objective (objective.hpp) is not below `samples` sample periods. This
/// is a quick choice by formula, with nine tenths of the verification's tolerance as slack. The caller must verify by
/// simulation. O(axes (N + d)) for a delay that holds, less for most others.
/// @param task  its own filter, if any, is ignored
/// @param stop  polled before every delay; true ends the search with no answer
std::optional<std::vector<int>> delays_by_formula(const Filter& filter, const Task& task, double samples,
                                                  const std::function<bool()>& stop = {});

}  // namespace accdec
