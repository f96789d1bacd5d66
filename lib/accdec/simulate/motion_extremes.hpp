#pragma once

#include <cstdint>

namespace accdec {

/// Largest values of a stretch of one axis' motion, in the units of its samples.
struct MotionExtremes {
  double velocity = 0.0, acceleration = 0.0, jerk = 0.0;  ///< of their magnitudes
  double force = 0.0;                                     ///< of |m a + c v|
  double power = 0.0, regeneration = 0.0;                 ///< of (m a + c v) v and of its opposite; 0 if never positive
};

/// @param v, a     velocity and acceleration of `n` samples; a[-1] is readable, too: jerk is a[k] - a[k - 1]
/// @param m, c     see `force`
/// @param loads  whether force, power and regeneration are needed
MotionExtremes motion_extremes(const double* v, const double* a, std::int64_t n, double m, double c, bool loads);

}  // namespace accdec
