#pragma once

#include <cstddef>

#include <accdec/task/tap_bounds.hpp>
#include <accdec/task/task.hpp>

namespace accdec {

/// Upper bounds of the smallest speed that any filter, whatever its order and the corner's delay, can keep through a
/// corner within its error.
///
/// Let k be the last sample at which leg 1 is as fast as leg 2. Across the bisector of the turn the motion runs into
/// the corner until then and out of it from then on, so the error is at least what it is across at sample k,
/// cos(theta / 2) times the sum of both legs' distances from the corner point. What a leg has left of its speed there
/// must have been gained, or must still be lost, with the taps that acceleration, force and jerk allow at start and
/// stop: the distance that takes at least rises with the speed. And both legs together, about as fast as each other,
/// must be as fast as the smallest speed.
class CornerSpeeds {
 public:
  explicit CornerSpeeds(const Task& task);
  /// m/s; infinite where the corner's own smallest speed is not known to be too much.
  double fastest(std::size_t corner) const;

 private:
  Task task_;  ///< with the limits that verification grants
  TapBounds bounds_;
};

}  // namespace accdec
