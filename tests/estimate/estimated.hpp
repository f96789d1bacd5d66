#pragma once

#include <cmath>
#include <map>
#include <string>

#include <accdec/program.hpp>

namespace accdec::test {

/// mm, mm/s, mm/s^2: the limits of every axis.
inline constexpr double velocity = 200.0, acceleration = 1000.0;

inline Machine estimated_machine() {
  Machine machine;
  machine.axes.resize(1);
  machine.axes[0].name = "x";
  machine.axes[0].velocity_max = 1e-3 * velocity;
  machine.axes[0].acceleration_max = 1e-3 * acceleration;
  return machine;
}

inline Toolpath estimated_path(const std::string& text) {
  LineSource source("test.ngc", text);
  ToolpathOptions options;
  options.clamp_feeds = true;
  options.error_max = 1e-5;
  return read_toolpath(source, estimated_machine(), options);
}

/// s, of a program in mm.
inline double estimated(const std::string& control, const std::string& text,
                        const std::map<std::string, double>& given = {}) {
  return estimate_time(estimated_path(text), estimated_machine(), control, given).time;
}

/// s, for a length in mm that is long enough to reach the cruising speed; speeds in mm/s.
inline double long_move(double length, double from, double cruise, double to, double a = acceleration) {
  const double ramps = (2.0 * cruise * cruise - from * from - to * to) / (2.0 * a);
  return (2.0 * cruise - from - to) / a + (length - ramps) / cruise;
}

}  // namespace accdec::test
