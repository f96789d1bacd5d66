#pragma once

#include <cstddef>

#include <accdec/task.hpp>
#include <accdec/task/tap_bounds.hpp>

namespace accdec {

/// Upper bounds of the smallest speed that any filter can keep through a corner within its error, for any order and any
/// delay of the corner.
///
/// Let k be the last sample at which leg 1 is as fast as leg 2. Seen across the bisector of the turn, the motion runs
/// into the corner up to this sample and out of it afterwards. So the error is at least the distance across at sample
/// k. This is cos(theta / 2) times the sum of both legs' distances from the corner point. The speed of a leg there must
/// have been gained before, or must still be lost. The taps for this are limited by acceleration, force and jerk at
/// start and stop. The distance this takes has a lower bound that rises with the speed. Both legs are about equally
/// fast there, and together they must reach the smallest speed.
class CornerSpeeds {
 public:
  explicit CornerSpeeds(const Task& task);
  /// m/s; infinite if the corner's own smallest speed is not known to be too high.
  double fastest(std::size_t corner) const;

 private:
  Task task_;  ///< with the limits that verification grants
  TapBounds bounds_;
};

}  // namespace accdec
