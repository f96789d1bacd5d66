#pragma once

#include <array>
#include <cstddef>

#include <accdec/machine.hpp>
#include <accdec/simulate.hpp>

namespace accdec {

/// A straight leg as a bound for any motion sees it.
struct TubeLeg {
  std::array<double, program_axis_count> direction{};  ///< unit vector
  std::array<double, program_axis_count> pace{};       ///< s/m: pace . velocity <= 1 for every velocity allowed on it
  double feed = unlimited;                             ///< m/s, of the whole velocity; unlimited: only the axes' own
  double radius = unlimited;                           ///< m, how far from the leg a motion may be
};

/// The least loss of a motion within a window of time around a moment: s, against moving at the full pace.
struct TubeLoss {
  double both = 0.0;           ///< on both legs together
  double in = 0.0, out = 0.0;  ///< on one of them, whatever it costs on the other
};

/// A window from `before` s ahead of the moment of a corner to `after` s behind it. See any_motion_bound.
struct TubeWindow {
  const TubeLeg* in = nullptr;
  const TubeLeg* out = nullptr;
  double tolerance = 0.0;  ///< m, from the corner at its moment
  double before = 0.0, after = 0.0;
};

/// By a linear program over the positions at 24 moments of the window, its multipliers put into the bound. Both ends
/// are free. The positions of any motion keep its rows:
/// - Second differences over h are at most a_max h^2, third ones j_max h^3, first ones v_max h. In seven directions
///   first differences are at most h times the higher feed of both legs.
/// - Before the corner's moment leg 1 is within its radius, seen in five directions around its end. After it leg 2 is.
///   At that moment the position lies in a polygon around the ball of the tolerance.
///
/// A window of no length has what a motion may save by cutting the corner: -|pace_in - pace_out| tolerance.
TubeLoss tube_loss(const TubeWindow& window, const Machine& machine, std::size_t dimensions);

/// The same from rest in the beginning of a leg, s: only `out` and `both`, which are equal. @param after  s
TubeLoss rest_loss(const TubeLeg& leg, double after, const Machine& machine, std::size_t dimensions);

}  // namespace accdec
