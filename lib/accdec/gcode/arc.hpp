#pragma once

#include <numbers>

#include <accdec/simulate.hpp>

namespace accdec {

/// LinuxCNC's tolerance in m on the radii at both ends of an arc given by its centre: two ends rounded to 0.01 mm or
/// 0.001 inch. See src/emc/rs274ngc/interp_internal.hh, CENTER_ARC_RADIUS_TOLERANCE_*.
inline constexpr double arc_rounding_mm = 2.0 * 1e-5 * std::numbers::sqrt2;
inline constexpr double arc_rounding_inch = 2.0 * 1e-3 * 0.0254 * std::numbers::sqrt2;

/// An arc or helix in the plane of two axes; all others move in proportion to the angle turned.
struct Arc {
  ProgramPoint from{}, to{};
  std::size_t first = 0, second = 1;  ///< axes of the plane; positive angles turn from the first to the second
  double center_first = 0.0, center_second = 0.0;  ///< m
  double angle = 0.0;                              ///< rad, signed
  double rounding = arc_rounding_mm;               ///< m, see arc_by_center
  double same =
      20e-9;  ///< m: ends this close are the same point; sums of decimals, and six decimals of an inch, differ by less
};

/// Why an arc cannot be made.
enum class ArcProblem { none, radius_differs, radius_zero, radius_too_small, same_end };

/// Arc by its centre. As in LinuxCNC, the radii at both ends may differ by `rounding` or 0.1 % of the larger one,
/// whichever is more, but never by 100 `rounding`. The arc is then a spiral. Radii below 1.27 um (0.00005 inch) count
/// as 0. The arc is a full circle if its end is the start, or ahead of it by at most `same` or an angle of 1e-6 rad
/// (LinuxCNC's CIRCLE_FUZZ). An end computed by adding up increments, or in another unit, misses the start by rounding
/// errors.
/// @param turns  whole turns started, >= 1
ArcProblem arc_by_center(Arc& arc, bool clockwise, int turns);
/// Arc by radius: up to a half turn for positive radii, more for negative ones. The chord may exceed the diameter by 20
/// um.
ArcProblem arc_by_radius(Arc& arc, bool clockwise, double radius, int turns);

/// Number of chords of equal angle that stay within `tolerance` (m, > 0) of the arc, at least one a quarter turn.
/// 0 if that would be more than 10 million.
int chord_count(const Arc& arc, double tolerance);
/// Largest distance of that many chords of equal angle from the arc, m.
double chord_distance(const Arc& arc, int chords);
/// End of chord i of n, 1 <= i <= n; the last is exactly `to`.
ProgramPoint chord_end(const Arc& arc, int i, int n);

}  // namespace accdec
