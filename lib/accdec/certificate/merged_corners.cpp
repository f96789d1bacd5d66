#include <fmt/format.h>

#include <accdec/certificate/checked_rows.hpp>
#include <accdec/certificate/merged_corners.hpp>
#include <accdec/task/equal_corners.hpp>

namespace accdec {

Task merged_corners(const Task& task, const std::vector<int>& corner_of) {
  if (corner_of.empty()) return task;
  if (corner_of.size() != task.corners.size())
    throw Rejected(
        fmt::format("the certificate merges {} corners, the task has {}", corner_of.size(), task.corners.size()));
  Task merged = task;
  merged.corners.clear();
  for (std::size_t i = 0; i < task.corners.size(); ++i) {
    const int kinds = static_cast<int>(merged.corners.size()), kind = corner_of[i];
    if (kind < 0 || kind > kinds) throw Rejected("the certificate merges a corner with one that is not there");
    if (kind == kinds) {
      merged.corners.push_back(task.corners[i]);
      continue;
    }
    TaskCorner& first = merged.corners[static_cast<std::size_t>(kind)];
    if (!ask_the_same(task.machine, first, task.corners[i]))
      throw Rejected(fmt::format("the certificate takes corners {} and {} for one, but they are not", first.name,
                                 task.corners[i].name));
    first.weight += task.corners[i].weight;
  }
  return merged;
}

}  // namespace accdec
