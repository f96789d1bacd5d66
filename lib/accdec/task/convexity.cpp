#include <algorithm>

#include <accdec/machine/limits.hpp>
#include <accdec/task/convexity.hpp>

namespace accdec {

bool friction_reverses(const Task& task) {
  for (const TaskCorner& corner : task.corners) {
    for (std::size_t i = 0; i < task.machine.axes.size(); ++i) {
      const auto a = static_cast<Eigen::Index>(i);
      const Axis& axis = task.machine.axes[i];
      if (axis.coulomb > 0.0 && std::min(axis.force_max, axis.force_speed_max) < unlimited &&
          corner.geometry().direction_in[a] * corner.geometry().direction_out[a] < 0.0)
        return true;
    }
  }
  return false;
}

bool is_convex(const Task& task) {
  const auto& axes = task.machine.axes;
  return !limits_supply(task.machine) && !friction_reverses(task) &&
         std::all_of(axes.begin(), axes.end(),
                     [](const Axis& a) { return a.power_max >= unlimited && a.regeneration_max >= unlimited; }) &&
         std::all_of(task.corners.begin(), task.corners.end(), [](const TaskCorner& c) { return c.speed_min <= 0.0; });
}

}  // namespace accdec
