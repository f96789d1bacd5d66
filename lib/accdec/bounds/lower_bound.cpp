#include <algorithm>
#include <cmath>

#include <accdec/bounds/lower_bound.hpp>
#include <accdec/bounds/window_bound.hpp>

namespace accdec {
double program_lower_bound(const Toolpath& path, const Machine& task_machine, double sample_period) {
  const std::size_t n = path.dimensions();
  const Machine all_limits = program_machine(task_machine, path);
  const auto unbounded = [](const Axis& axis) { return !(axis.acceleration_max < unlimited); };
  const bool without = std::any_of(all_limits.axes.begin(), all_limits.axes.end(), unbounded);
  const Machine machine = without ? Machine{} : all_limits;
  double any_direction2 = machine.axes.empty() ? unlimited : 0.0;
  for (const Axis& axis : machine.axes) any_direction2 += axis.acceleration_max * axis.acceleration_max;
  const double any_direction = std::sqrt(any_direction2);
  // See the header: these belong to a continuous motion within these accelerations that represents the samples.
  const double saved = machine.axes.empty() ? 0.0 : sample_period,
               wider = machine.axes.empty() ? 0.0 : any_direction * saved * saved / 8.0;
  const auto tolerance = [&](std::size_t joint) {
    return path.joint[joint] == Joint::stop ? 0.0 : path.tolerance[joint] + path.narrowed;
  };

  double time = path.dwells();
  for (std::size_t first = 0; first < path.blocks();) {
    std::size_t last = first;
    while (path.joint[last] != Joint::stop) ++last;
    double cruise = 0.0, way = 0.0, fastest = 0.0, direct = any_direction;
    for (std::size_t b = first; b <= last; ++b) {
      const double* p = path.point(b);
      double length2 = 0.0;
      for (std::size_t a = 0; a < n; ++a) length2 += (p[n + a] - p[a]) * (p[n + a] - p[a]);
      const double length = std::sqrt(length2), speed = length / path.duration[b];
      const double left =
          std::max(0.0, length - (b > first ? tolerance(b - 1) : 0.0) - (b < last ? tolerance(b) : 0.0));
      cruise += left / speed;
      way += left;
      fastest = std::max(fastest, speed);
      for (std::size_t a = 0; first == last && a < machine.axes.size(); ++a) {
        const double part = std::abs(p[n + a] - p[a]) / length;
        if (part > 0.0) direct = std::min(direct, machine.axes[a].acceleration_max / part);
      }
    }
    // All blocks at their feeds without ramps, or all at the highest feed with them, or windows of them.
    const double ramped = time_from_rest(way - 2.0 * static_cast<double>(last - first) * wider, fastest, direct, 2);
    const double windows = last > first ? window_bound(path, machine, wider + path.narrowed, first, last) : 0.0;
    time += std::max({cruise, ramped - saved, windows - saved});
    first = last + 1;
  }
  return time;
}

}  // namespace accdec
