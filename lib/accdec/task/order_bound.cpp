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

/// The fewest taps of the sum 1 within acceleration and jerk of the axes. They bound every tap and the step between
/// neighbours, with zeros beyond the ends.
int fewest_taps(const Task& task, int limit) {
  double size = 1.0, step = 1.0;
  const double period = task.sample_period;
  for (const TaskCorner& corner : task.corners) {
    for (std::size_t i = 0; i < task.machine.axes.size(); ++i) {
      const auto a = static_cast<Eigen::Index>(i);
      const Corner& g = corner.geometry();
      const double fastest =
          std::max(g.feed_in * std::abs(g.direction_in[a]), g.feed_out * std::abs(g.direction_out[a]));
      if (fastest == 0.0) continue;
      size = std::min(size, task.machine.axes[i].acceleration_max * period / fastest);
      step = std::min(step, task.machine.axes[i].jerk_max * period * period / fastest);
    }
  }
  double sum = 0.0;
  int taps = 0;
  // One more tap stands in the middle of those before.
  while (sum < 1.0 - 1e-9 && taps <= limit + 1) ++taps, sum += std::min(size, step * ((taps + 1) / 2));
  return taps;
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
  if (taps.empty()) return limit + 1;
  return std::min(limit + 1, std::max(static_cast<int>(taps.size()), fewest_taps(*limits_on_taps(task), limit)) - 1);
}

}  // namespace accdec
