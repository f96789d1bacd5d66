#include <algorithm>

#include <accdec/machine/limits.hpp>
#include <accdec/task/convexity.hpp>

namespace accdec {

bool is_convex(const Task& task) {
  const auto& axes = task.machine.axes;
  return !limits_supply(task.machine) && std::all_of(axes.begin(), axes.end(), [](const Axis& a) {
    return a.power_max >= unlimited && a.regeneration_max >= unlimited;
  }) && std::all_of(task.corners.begin(), task.corners.end(), [](const TaskCorner& c) { return c.speed_min <= 0.0; });
}

}  // namespace accdec
