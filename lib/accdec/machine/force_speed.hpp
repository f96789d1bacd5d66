#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <accdec/machine.hpp>

namespace accdec {

/// The largest force that an axis ever has, N.
inline double force_limit(const Axis& axis) {
  return std::min(axis.force_max, axis.force_speed_max);
}
/// A force at a speed, scaled to standstill: the curve's first force where the sample is on the curve, and in
/// proportion to the sample elsewhere. As the curve is concave, that is the largest of one value a line:
///   f_0 (|F| + s |V'|)/f  for the line |F| = f - s |V'|,
/// and f_0 |V'|/v_last, as nothing is allowed beyond the last speed. @return N; 0 without a curve
inline double at_standstill(const Axis& axis, double velocity, double force) {
  const std::vector<SpeedForce>& curve = axis.force_speed;
  if (curve.empty()) return 0.0;
  const double v = std::abs(velocity), f = std::abs(force), first = curve.front().force;
  double most = std::max(f, first * v / curve.back().speed);
  for (std::size_t i = 0; i + 1 < curve.size(); ++i) {
    const double slope = (curve[i].force - curve[i + 1].force) / (curve[i + 1].speed - curve[i].speed);
    most = std::max(most, first * (f + slope * v) / (curve[i].force + slope * curve[i].speed));
  }
  return most;
}

/// A line of the curve: |F| + slope |V'| <= force.
struct ForceLine {
  double slope = 0.0;  ///< N s/m, >= 0
  double force = 0.0;  ///< N
};
/// The lines of an axis' curve, scaled to its `force_speed_max`. They leave out that nothing is allowed beyond the last
/// speed: no blend is faster than its legs. The first is that below the first speed.
inline std::vector<ForceLine> force_lines(const Axis& axis) {
  std::vector<ForceLine> lines;
  const std::vector<SpeedForce>& curve = axis.force_speed;
  if (curve.empty() || !(axis.force_speed_max < unlimited)) return lines;
  const double scale = axis.force_speed_max / curve.front().force;
  lines.push_back({0.0, axis.force_speed_max});
  for (std::size_t i = 0; i + 1 < curve.size(); ++i) {
    const double slope = (curve[i].force - curve[i + 1].force) / (curve[i + 1].speed - curve[i].speed);
    lines.push_back({slope, scale * (curve[i].force + slope * curve[i].speed)});
  }
  return lines;
}

/// Largest force at a speed up to the curve's last, N.
inline double force_at(const Axis& axis, double speed) {
  double least = unlimited;
  for (const ForceLine& line : force_lines(axis)) least = std::min(least, line.force - line.slope * speed);
  return least;
}
/// The speed where the curve ends, m/s.
inline double last_speed(const Axis& axis) {
  return axis.force_speed.back().speed * (axis.force_speed_max / axis.force_speed.front().force);
}
/// Scales the curve's forces at their speeds, so that it begins with `first`, N, > 0.
inline void scale_forces(Axis& axis, double first) {
  const double scale = first / axis.force_speed.front().force;
  for (SpeedForce& point : axis.force_speed) point.force *= scale;
  axis.force_speed.front().force = axis.force_speed_max = first;
}

}  // namespace accdec
