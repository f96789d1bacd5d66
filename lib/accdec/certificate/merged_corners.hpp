#pragma once

#include <vector>

#include <accdec/task.hpp>

namespace accdec {

/// The task with one corner for each kind that a proof names, with the weights of all its members. A design that holds
/// all members holds the first of them at the smallest of their delays, which costs no more.
/// @param corner_of  see proof::BranchAndBound; empty: the task as it is
/// @throws Rejected if the number differs from that of corners, one is out of order, or two corners have different
/// requirements
Task merged_corners(const Task& task, const std::vector<int>& corner_of);

/// The task of the filter and the control's smoothing of P + 1 taps as one filter of P more. All that limits and
/// tolerances see is this filter. It may have any taps, which only allows more.
/// @throws Rejected if there is no smoothing
Task with_smoothing(const Task& task);

}  // namespace accdec
