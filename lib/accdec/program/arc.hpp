#pragma once

#include <accdec/program/move.hpp>

namespace accdec {

/// An arc or helix in the plane of two axes; all others move in proportion to the angle turned.
struct Arc {
  ProgramPoint from{}, to{};
  std::size_t first = 0, second = 1;         ///< axes of the plane; positive angles turn from the first to the second
  double center_first = 0.0, center_second = 0.0;  ///< m
  double angle = 0.0;                        ///< rad, signed
};

/// Why an arc cannot be made.
enum class ArcProblem { none, radius_differs, radius_zero, radius_too_small, same_end };

/// Arc by its centre. Radii at both ends may differ by the rounding of the program: 10 um or 0.1 %, the arc is then a spiral.
/// @param turns  whole turns begun, >= 1 @param end equals start: a full circle
ArcProblem arc_by_center(Arc& arc, bool clockwise, int turns);
/// Arc by radius: up to a half turn for positive radii, more for negative ones. The chord may exceed the diameter by 10 um.
ArcProblem arc_by_radius(Arc& arc, bool clockwise, double radius, int turns);

/// Number of chords of equal angle that stay within `tolerance` (m, > 0) of the arc, at least one a quarter turn.
/// 0 if that would be more than 10 million.
int chord_count(const Arc& arc, double tolerance);
/// End of chord i of n, 1 <= i <= n; the last is exactly `to`.
ProgramPoint chord_end(const Arc& arc, int i, int n);

}  // namespace accdec
