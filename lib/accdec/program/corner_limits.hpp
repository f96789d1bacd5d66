#pragma once

#include <vector>

#include <accdec/machine/machine.hpp>
#include <accdec/motion/filter.hpp>

namespace accdec {

/// Whether a lone joint with a delay holds the axis limits while the legs overlap: velocity, acceleration, jerk, force, power,
/// regeneration, the same bounds as `axis_utilisation` without its ends at rest. Made for millions of joints: most are settled by
/// what holds for every delay, the others sample by sample with an early way out.
class CornerLimits {
 public:
  CornerLimits(const Filter& filter, const Machine& machine, double sample_period);

  /// Largest factor <= 1 on a velocity, m/s an axis, with which a start from rest or a stop to rest surely holds the limits.
  double start_factor(const double* velocity) const;
  /// Smallest d >= from with all limits held; `from` itself if even legs so far apart that they do not overlap (d = N + 2) break one.
  /// @param in, out  velocities of the legs, m/s, one value an axis  @param possible  set to false in that case, else left alone
  int smallest(const double* in, const double* out, int from, bool& possible) const;

 private:
  bool any_delay_holds(const double* in, const double* out, int from) const;
  bool holds(const double* in, const double* out, int delay) const;

  const Filter& filter_;
  const Machine& machine_;
  double period_;
  double tap_max_ = 0.0, tap_step_max_ = 0.0;
  std::vector<std::size_t> limited_;  // axes with any limit
};

}  // namespace accdec
