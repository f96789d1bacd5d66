#include <algorithm>
#include <cmath>

#include <accdec/task/limits_on_taps.hpp>
#include <accdec/task/order_bound.hpp>

namespace accdec {
namespace {

struct Plant {
  double speed = 0.0;  // m/s at the end of the start
  const Axis* axis = nullptr;
};

/// Largest B_k that one axis allows after B_{k-1}, with F = s (m b/T + c B_k) and P = s F B_k.
double next_cumulative(const Plant& plant, double before, double period) {
  const Axis& axis = *plant.axis;
  const double s = plant.speed, inertia = axis.mass / period;
  double next = before + axis.acceleration_max * period / s;
  const double slope = s * (inertia + axis.damping);
  if (axis.force_max < unlimited && slope > 0.0) next = std::min(next, (axis.force_max + s * inertia * before) / slope);
  if (axis.power_max < unlimited && slope > 0.0) {
    // s^2 B ((m/T + c) B - m/T before) <= P, the positive root
    const double a = s * slope, b = -s * s * inertia * before;
    next = std::min(next, (-b + std::sqrt(b * b + 4.0 * a * axis.power_max)) / (2.0 * a));
  }
  return next;
}

}  // namespace

std::vector<double> saturating_start(const Task& whole, int limit) {
  const std::shared_ptr<const Task> on_taps = limits_on_taps(whole);
  const Task& task = *on_taps;
  std::vector<Plant> plants;
  for (const TaskCorner& corner : task.corners) {
    for (std::size_t a = 0; a < task.machine.axes.size(); ++a) {
      const double s =
          std::abs(corner.geometry().feed_in * corner.geometry().direction_in[static_cast<Eigen::Index>(a)]);
      if (s > 0.0) plants.push_back({s, &task.machine.axes[a]});
    }
  }
  std::vector<double> taps;
  double cumulative = 0.0;
  while (cumulative < 1.0) {
    if (static_cast<int>(taps.size()) > limit) return {};
    double next = 1.0;
    for (const Plant& plant : plants) next = std::min(next, next_cumulative(plant, cumulative, task.sample_period));
    // The last tap may fall an ulp short of the end.
    if (next > 1.0 - 1e-12) next = 1.0;
    if (next <= cumulative) return {};
    taps.push_back(next - cumulative);
    cumulative = next;
  }
  return taps;
}

int order_lower_bound(const Task& task, int limit) {
  const std::vector<double> taps = saturating_start(task, limit);
  return taps.empty() ? limit + 1 : static_cast<int>(taps.size()) - 1;
}

}  // namespace accdec
