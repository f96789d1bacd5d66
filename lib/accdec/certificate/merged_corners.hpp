#pragma once

#include <vector>

#include <accdec/task/task.hpp>

namespace accdec {

/// The task with one corner for each kind that a proof names, with the weights of all its members. Whoever holds the
/// members holds the first of them at the least of their delays, which costs no more.
/// @param corner_of  see proof::BranchAndBound; empty: the task as it is
/// @throws Rejected if there are not as many as corners, one is out of order, or two do not ask the same
Task merged_corners(const Task& task, const std::vector<int>& corner_of);

}  // namespace accdec
