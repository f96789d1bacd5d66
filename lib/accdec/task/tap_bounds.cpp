#include <algorithm>
#include <cmath>

#include <accdec/task/tap_bounds.hpp>

namespace accdec {

TapBounds tap_bounds(const Task& task) {
  const double period = task.sample_period;
  TapBounds bounds;
  for (const TaskCorner& corner : task.corners) {
    const Corner& g = corner.geometry();
    for (std::size_t i = 0; i < task.machine.axes.size(); ++i) {
      const Axis& axis = task.machine.axes[i];
      const auto a = static_cast<Eigen::Index>(i);
      const double in = std::abs(g.feed_in * g.direction_in[a]), out = std::abs(g.feed_out * g.direction_out[a]);
      const double fastest = std::max(in, out);
      if (fastest > 0.0) {
        bounds.most = std::min(bounds.most, axis.acceleration_max * period / fastest);
        bounds.step = std::min(bounds.step, axis.jerk_max * period * period / fastest);
      }
      if (in > 0.0 && axis.mass > 0.0) bounds.most = std::min(bounds.most, axis.force_max * period / (axis.mass * in));
    }
  }
  return bounds;
}

}  // namespace accdec
