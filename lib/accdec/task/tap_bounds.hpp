#pragma once

#include <accdec/task.hpp>

namespace accdec {

/// Bounds on taps from starts and stops. Acceleration and force bound every tap. Force counts the mass only, because
/// friction only adds to it at a start. Jerk bounds the difference of two neighbours, and so the first and the last
/// tap.
struct TapBounds {
  double most = 1.0, step = unlimited;
};
/// @param task  with the limits that are to hold to the last bit (granted_limits.hpp for what verification allows)
TapBounds tap_bounds(const Task& task);

}  // namespace accdec
