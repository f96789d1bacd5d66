#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include <accdec/machine.hpp>

// Data of program_corner_bound.cpp about a leg, and the steps into which it sorts the leg's highest speed.

namespace accdec {

inline constexpr std::size_t bound_steps = 24;   // steps of a leg's highest speed, from its feed down
inline constexpr double bound_step_ratio = 1.1;  // of one to the next

/// Step s of a leg's speeds runs from feed/1.1^(s + 1) to feed/1.1^s; the last one begins at 0.
inline double step_part(std::size_t s) {
  static const std::array<double, bound_steps> parts = [] {
    std::array<double, bound_steps> powers{};
    for (std::size_t k = 0; k < bound_steps; ++k) powers[k] = std::pow(bound_step_ratio, -static_cast<double>(k));
    return powers;
  }();
  return parts[s];
}

/// Blocks between two joints that turn or stop.
struct BoundLeg {
  std::size_t first = 0, last = 0;  // blocks
  double length = 0.0, feed = 0.0, acceleration = unlimited, jerk = unlimited;
  double rests = 0.0, corners = 0.0;  // ends at rest; ends that count
  int corner_class = -1;              // of the corner at its end, where that counts

  /// From rest to v, or as much faster, with no acceleration at both ends.
  double ramp(double v) const {
    if (!(jerk < unlimited)) return acceleration < unlimited ? v / acceleration : 0.0;
    if (v * jerk >= acceleration * acceleration) return v / acceleration + acceleration / jerk;
    return 2.0 * std::sqrt(v / jerk);
  }

  /// From rest to rest: the way at v and both ramps, v as high as the length lets it come to (by bisection: length = v
  /// ramp(v)).
  double rest_to_rest() const {
    double high = feed;
    if (feed * ramp(feed) > length) {
      double low = 0.0;
      for (int i = 0; i < 60; ++i) {
        const double v = 0.5 * (low + high);
        (v * ramp(v) > length ? high : low) = v;
      }
    }
    return length / high + ramp(high);
  }

  std::size_t expected_step() const {
    std::size_t s = 0;
    while (s + 2 < bound_steps && feed * step_part(s) * ramp(feed * step_part(s)) > bound_step_ratio * length) ++s;
    return s;
  }

  /// Least time of the leg at a step, without its corners.
  double time(std::size_t s) const {
    if (rests == 2.0) return rest_to_rest();
    const double v = feed * step_part(s);
    if (s + 1 == bound_steps) return length / v;
    const double faster = v - feed * step_part(s + 1);
    return length / v + rests * 0.5 * ramp(v) - (rests + corners) * faster * ramp(faster) / (2.0 * v);
  }
};

}  // namespace accdec
