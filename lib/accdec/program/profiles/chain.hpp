#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

namespace accdec {

/// A program as the look-ahead sees it: legs (one a block) between corners (one a point, the ends included).
///
/// A corner is passed at one speed v, by a boxcar of `stretch * v` seconds: it takes `stretch v^2/2` of each leg, plus
/// what a steady stretch of `coast` seconds on either side takes. A leg ramps between the speeds of its corners and up
/// to its feed where there is room. The acceleration along a leg is constant within each of `levels` equal parts of its
/// feed.
struct ProfileChain {
  int levels = 1;
  double peak_coast = 0.0;           ///< s at least between speeding up and braking
  std::vector<double> length, feed;  ///< of every leg, m and m/s
  std::vector<double> ramp;          ///< legs rows of `levels`, m/s^2
  std::vector<double> speed_max;     ///< of every corner, m/s; 0 where the motion comes to rest, see `stops`
  std::vector<double> stretch;       ///< of every corner, s^2/m
  std::vector<double> coast;         ///< of every corner, s
  std::vector<double> speed;         ///< result, of every corner, m/s
  std::vector<double> peak;          ///< result, of every leg, m/s

  std::size_t legs() const { return length.size(); }
  /// Whether the motion stops at corner c, on a sample and until the last boxcar is empty; with a coast it only waits
  /// there for twice that.
  bool stops(std::size_t c) const { return !(speed_max[c] > 0.0) && !(coast[c] > 0.0); }
  /// What corner c takes of each of its legs at a speed, m.
  double taken(std::size_t c, double v) const { return (0.5 * stretch[c] * v + coast[c]) * v; }
  /// Way from rest to a speed along leg b, m.
  double way(std::size_t b, double v) const {
    if (levels == 1) return 0.5 * v * v / ramp[b];
    const double width = feed[b] / levels;
    double sum = 0.0;
    for (int k = 0; k < levels; ++k) {
      const double low = k * width, high = k + 1 == levels ? v : (k + 1) * width;
      if (v <= low) break;
      const double top = v < high ? v : high;
      sum += 0.5 * (top - low) * (top + low) / ramp[b * static_cast<std::size_t>(levels) + static_cast<std::size_t>(k)];
    }
    return sum;
  }
};

/// Speeds of all corners and peaks of all legs: a share of every leg that is too short for both its corners, a pass
/// backward for braking, one forward for speeding up, and rounds that raise each corner as far as its neighbours let
/// it. O(blocks); what is found can be driven. In look_ahead.cpp.
void look_ahead(ProfileChain& chain);

}  // namespace accdec
