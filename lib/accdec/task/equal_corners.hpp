#pragma once

#include <vector>

#include <accdec/task/task.hpp>

namespace accdec {

/// Whether two corners ask the same of every filter and delay, up to a part in 10^12 (a thousandth of what the
/// verification grants): same feeds, tolerance, smallest speed and given delay, and legs that differ by axes turned
/// round or by an exchange of axes with the same limits. Names and weights do not count.
bool ask_the_same(const Machine& machine, const TaskCorner& a, const TaskCorner& b);

/// A task in which corners that ask the same are one, with all their weight. A filter that holds one holds them all at
/// the same delay, so both tasks have the same shortest time.
struct MergedTask {
  Task task;            ///< of each kind of corner the first
  std::vector<int> of;  ///< by corner of the whole task: the corner in `task` that stands for it

  bool smaller() const { return task.corners.size() < of.size(); }
  /// Delays of the whole task.
  std::vector<int> expand(const std::vector<int>& delays) const;
};
/// Empty if no two ask the same. O(corners * kinds) at most.
MergedTask merge_equal_corners(const Task& task);

}  // namespace accdec
