#pragma once

#include <vector>

#include <accdec/task.hpp>

namespace accdec {

/// Whether two corners have the same requirements for every filter and delay, up to a part in 10^12 (a thousandth of
/// what the verification grants). Feeds, tolerance, smallest speed and given delay must be equal. The legs may differ
/// by reversed axes, or by an exchange of axes with the same limits. Names and weights do not count.
bool ask_the_same(const Machine& machine, const TaskCorner& a, const TaskCorner& b);

/// A task in which equal corners are merged into one with all their weight. A filter that holds one of them holds all
/// at the same delay, so both tasks have the same shortest time.
struct MergedTask {
  Task task;            ///< with the first corner of each kind
  std::vector<int> of;  ///< by corner of the whole task: the corner in `task` that stands for it

  bool smaller() const { return task.corners.size() < of.size(); }
  /// Delays of the whole task.
  std::vector<int> expand(const std::vector<int>& delays) const;
};
/// Empty if no two corners are equal. O(corners * kinds) at most.
MergedTask merge_equal_corners(const Task& task);

}  // namespace accdec
