#pragma once

#include <vector>

#include <accdec/exact/box.hpp>
#include <accdec/exact/rows.hpp>

namespace accdec::exact {

/// Bounds on the cumulative responses of a box: the values that the limits on starts and stops can reach. Behind a
/// response they are those of the motion, whose taps and differences are averages of the command's.
class TubeLimits {
 public:
  TubeLimits(const Task& task, const ConvexRows& rows);
  /// Shrinks the box's tube. False: nothing is left of it.
  bool shrink(Box& box) const;

 private:
  /// Start or stop of one axis: x = B_{k-1}, y = B_k, F = s ((m/T + c) y - m/T x) and its mirror image.
  struct Plant {
    double inertia, drag;               ///< m/T, c
    double force, power, regeneration;  ///< F/s, P/s^2 and P_regen/s^2
    bool stop;
    double most_after(double x, double high) const;
    /// Least x before a y in [low, high].
    double least_before(double low, double high) const;
  };
  void begin(Box& box) const;

  int longer_;                 ///< order of the response
  double tap_max_, jerk_max_;  ///< of the command
  std::vector<Plant> plants_;
};

}  // namespace accdec::exact
