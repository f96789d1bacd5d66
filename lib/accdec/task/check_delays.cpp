#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <accdec/task/check_delays.hpp>
#include <accdec/task/simulation.hpp>
#include <accdec/task/verifier.hpp>

namespace accdec {
namespace {

/// Velocity and position of the two legs on their own, rows k = 0 .. N + 2 from their command edges.
struct Legs {
  Eigen::MatrixXd stop_velocity, stop_position, start_velocity, start_position;
};

Legs simulate_legs(const Filter& filter, const Corner& corner, double period) {
  const int n = filter.order(), apart = n + 3;
  const SampledMotion m = simulate_corner(filter, corner, apart, period);
  return {m.velocity.middleRows(m.corner, n + 3), m.position.middleRows(m.corner, n + 3),
          m.velocity.middleRows(m.corner + apart, n + 3), m.position.middleRows(m.corner + apart, n + 3)};
}

/// Whether the blend at a delay breaks any limit of a corner.
bool breaks(const Task& task, const TaskCorner& corner, const Legs& legs, int delay) {
  const double period = task.sample_period, allowed = 1.0 + verification_tolerance;
  const Eigen::Index tail = legs.stop_velocity.rows() - 1, axes = legs.stop_velocity.cols();
  const Eigen::Index last = tail + delay;
  double nearest = unlimited, slowest = unlimited;
  Eigen::VectorXd before_velocity, before_acceleration = Eigen::VectorXd::Zero(axes);
  for (Eigen::Index k = 0; k <= last; ++k) {
    const Eigen::Index m = std::clamp<Eigen::Index>(k - delay, 0, tail), in = std::min(k, tail);
    const Eigen::VectorXd v = (legs.stop_velocity.row(in) + legs.start_velocity.row(m)).transpose();
    const Eigen::VectorXd s = (legs.stop_position.row(in) + legs.start_position.row(m)).transpose();
    nearest = std::min(nearest, s.norm());
    if (k <= last - 1) slowest = std::min(slowest, v.norm());
    const Eigen::VectorXd acceleration =
        k == 0 ? Eigen::VectorXd::Zero(axes).eval() : ((v - before_velocity) / period).eval();
    for (Eigen::Index a = 0; a < axes; ++a) {
      const Axis& axis = task.machine.axes[static_cast<std::size_t>(a)];
      const double force = axis.mass * acceleration[a] + axis.damping * v[a];
      if (std::abs(v[a]) > axis.velocity_max * allowed || std::abs(acceleration[a]) > axis.acceleration_max * allowed ||
          std::abs(acceleration[a] - before_acceleration[a]) / period > axis.jerk_max * allowed ||
          std::abs(force) > axis.force_max * allowed || force * v[a] > axis.power_max * allowed ||
          -force * v[a] > axis.regeneration_max * allowed) {
        return true;
      }
    }
    before_velocity = v;
    before_acceleration = acceleration;
  }
  if (corner.error_max && nearest > position_floor && nearest > *corner.error_max * allowed) return true;
  return corner.speed_min > slowest * allowed;
}

}  // namespace

std::string check_smallest_delays(const Task& task, const Filter& filter, const std::vector<int>& delays) {
  for (std::size_t j = 0; j < task.corners.size(); ++j) {
    const TaskCorner& corner = task.corners[j];
    if (corner.delay) continue;
    const Legs legs = simulate_legs(filter, corner.geometry(), task.sample_period);
    for (int d = 0; d < delays[j]; ++d) {
      if (!breaks(task, corner, legs, d)) {
        return fmt::format("corner {}: delay {} is claimed to be the smallest, but {} holds every limit too",
                           corner.name, delays[j], d);
      }
    }
  }
  return {};
}

std::string check_no_delays(const Task& task, const Filter& filter) {
  Task part = task;
  part.corners.clear();
  if (!verify_by_simulation(part, filter, {}).feasible) return {};  // vibration, in which delays have no part
  part.machine.modes.clear();
  // With d = N + 1 the legs no longer overlap, but the jerk spans both; from N + 2 on nothing changes any more.
  const auto holds = [&](int delay) { return verify_by_simulation(part, filter, {delay}).feasible; };
  for (const TaskCorner& corner : task.corners) {
    part.corners = {corner};
    const int last = corner.delay.value_or(filter.order() + 2);
    int delay = corner.delay.value_or(0);
    while (delay <= last && !holds(delay)) ++delay;
    if (delay > last) return {};
  }
  return "every corner holds its limits with some delay of this filter";
}

}  // namespace accdec
