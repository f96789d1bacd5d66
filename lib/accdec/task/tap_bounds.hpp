#pragma once

#include <accdec/task/task.hpp>

namespace accdec {

/// What starts and stops allow of any tap: acceleration and force (of the mass alone, which friction only adds to at a
/// start) bound every tap, jerk the difference of two neighbours and so the first and the last.
struct TapBounds {
  double most = 1.0, step = unlimited;
};
/// @param task  with the limits that are to hold to the last bit (granted_limits.hpp for what verification allows)
TapBounds tap_bounds(const Task& task);

}  // namespace accdec
