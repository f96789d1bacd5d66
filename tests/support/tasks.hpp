#pragma once

#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include <accdec/task.hpp>

namespace accdec::testing {

inline double degrees(double d) {
  return d * std::numbers::pi / 180.0;
}

/// A corner in the plane, feeds in m/s.
inline TaskCorner plane_corner(const std::string& name, double angle_deg, double heading_deg, double feed_in,
                               double feed_out) {
  return TaskCorner(name, PlanarLegs{degrees(angle_deg), degrees(heading_deg), Turn::left}, feed_in, feed_out);
}

/// Two equal axes x and y and one corner of the given tolerance.
inline Task plane_task(const Axis& axis, TaskCorner corner, std::optional<double> error_max) {
  Task task;
  for (const char* name : {"x", "y"}) {
    task.machine.axes.push_back(axis);
    task.machine.axes.back().name = name;
  }
  corner.error_max = error_max;
  task.corners.push_back(std::move(corner));
  return task;
}

inline Filter random_filter(std::mt19937& rng, int order) {
  std::uniform_real_distribution<double> u(0.0, 1.0);
  std::vector<double> taps;
  for (int i = 0; i <= order; ++i) taps.push_back(u(rng) < 0.1 ? 0.0 : u(rng));
  taps[static_cast<std::size_t>(order) / 2] += 0.5;
  return Filter(std::move(taps));
}

/// Any limit may be there; magnitudes such that each binds for some filters of order about 20 and not for others.
inline Task random_task(std::mt19937& rng, int corners) {
  std::uniform_real_distribution<double> u(0.0, 1.0);
  Task task;
  for (const char* name : {"x", "y"}) {
    Axis axis;
    axis.name = name;
    if (u(rng) < 0.5) axis.acceleration_max = 5.0 + 20.0 * u(rng);
    if (u(rng) < 0.5) axis.jerk_max = 1000.0 + 20000.0 * u(rng);
    axis.mass = 10.0 + 40.0 * u(rng);
    axis.damping = 300.0 * u(rng);
    if (u(rng) < 0.5) axis.force_max = 200.0 + 800.0 * u(rng);
    if (u(rng) < 0.5) axis.power_max = 30.0 + 150.0 * u(rng);
    if (u(rng) < 0.5) axis.regeneration_max = 10.0 + 100.0 * u(rng);
    task.machine.axes.push_back(axis);
  }
  for (int j = 0; j < corners; ++j) {
    task.corners.push_back(plane_corner(std::string(1, static_cast<char>('A' + j)), 5.0 + 170.0 * u(rng),
                                        360.0 * u(rng), 0.05 + 0.3 * u(rng), 0.05 + 0.3 * u(rng)));
    task.corners.back().error_max = 5e-6 + 200e-6 * u(rng);
    if (u(rng) < 0.3) task.corners.back().speed_min = 0.05 * u(rng);
    task.corners.back().weight = 0.5 + u(rng);
  }
  return task;
}

}  // namespace accdec::testing
