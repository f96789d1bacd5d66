#pragma once

#include <cstddef>
#include <vector>

#include <accdec/files.hpp>
#include <accdec/machine.hpp>
#include <accdec/program.hpp>
#include <accdec/simulate.hpp>

namespace accdec {

/// A corner of two straight legs, each with the highest speed it reaches before and after the corner.
struct BoundCorner {
  const double* in = nullptr;              ///< unit vectors, one value per axis
  const double* out = nullptr;             ///< see `in`
  double speed_in = 0.0, speed_out = 0.0;  ///< m/s, > 0
  double feed = 0.0;                       ///< m/s, bound on both legs together, >= either speed
  double reach_in = 0.0, reach_out = 0.0;  ///< s, time considered before and after the corner; longer is tighter
  double tolerance = 0.0;                  ///< m, >= 0
};

/// Lower bound on the time lost at a corner for all speeds, from the multipliers of its linear program.
struct CornerDual {
  double period = 0.0;          ///< s
  double sides = 0.0;           ///< the multipliers times the sides of their rows
  std::vector<double> in, out;  ///< the multipliers' part in every column: a leg's speed in one period over its highest
  /// Time lost, s, against both legs at their highest speeds, where these are `of_in` and `of_out` times those that the
  /// program was solved for. It is valid for all of them by weak duality, and tight for the speeds of the linear
  /// program and along of_in = of_out. It is below 0 if cutting the corner saves more than turning costs.
  double at(double of_in = 1.0, double of_out = 1.0) const;
};

/// A lower bound on the time such a corner costs compared with passing it at both speeds, for any filters, delays and
/// feeds. It is the dual of a linear program. Its multipliers are inserted into the bound here, so the solver need not
/// be trusted.
///
/// Assumptions about the motion: x = sum of u_i s_i, where both s_i never fall and are not faster than their highest
/// speeds. Only the two legs move meanwhile. Together they are not faster than the feed, and they move at once only
/// within the reach. At one moment the path is within the tolerance of the corner. The axes keep their acceleration
/// (including force at rest) and jerk limits. The motion is sampled so that this moment is a sample. Then its
/// differences keep the limits and are linear in the speeds of the legs. The ball of the tolerance is replaced by a
/// polygon around it.
/// @param periods  number in the reach; more are tighter
CornerDual corner_loss(const BoundCorner& corner, const Machine& machine, std::size_t dimensions, int periods);

inline constexpr std::size_t corner_programs_max = 400;  ///< linear programs of a CornerBound

/// The motions are sums of legs that never run back. Let w_i be the highest speed that leg i reaches if one of its ends
/// counts, and its feed otherwise. Then sum of s_i'/w_i <= 1 at every moment, as in a filtered command. When a leg that
/// counts is fastest, no other one moves. A chord of an arc never counts, because filters are longer than it: it takes
/// its length over the feed. Chords are those of the path: a plan that read its arcs again has another bound.
///
/// The bound is the minimum, over all highest speeds v_i of the legs i, of the sum of L_i/v_i and of the corners' costs
/// at these speeds. Dwells count fully. In program_corner_bound.cpp. THEORY.md, "Corners of monotone legs", has the
/// derivation, and "Samples and continuous motion" says what is subtracted for samples. With a jerk limit it is the
/// larger of the bounds with and without that limit; the first has half of the time.
/// @param machine  its axes are found by their names (program_machine)  @param deadline  for the linear programs
CornerBound program_corner_bound(const Toolpath& path, const Machine& machine, double sample_period,
                                 const Deadline& deadline);

/// The largest acceleration of an axis at any speed up to its limit: friction helps to brake. m/s^2
double acceleration_most(const Axis& axis);

/// The same machine without jerk limits: a bound for it holds for the machine, too.
Machine without_jerk_limits(Machine machine);

/// How far the spline of a sampled motion, see program_corner_bound, is from its samples.
struct SplineSlack {
  double wider = 0.0;  ///< m, largest distance from the polyline of the samples
  double saved = 0.0;  ///< s, by which it comes to rest later
};
SplineSlack spline_slack(const Machine& machine, double sample_period);

}  // namespace accdec
