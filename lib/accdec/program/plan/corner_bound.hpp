#pragma once

#include <cstddef>
#include <vector>

#include <accdec/machine/machine.hpp>
#include <accdec/program/read/toolpath.hpp>

namespace accdec {

/// A corner of two straight legs, each with the highest speed that it comes to before and after.
struct BoundCorner {
  const double* in = nullptr;              ///< unit vectors, one value an axis
  const double* out = nullptr;             ///< see `in`
  double speed_in = 0.0, speed_out = 0.0;  ///< m/s, > 0
  double feed = 0.0;                       ///< m/s, what both legs together keep to, >= either speed
  double reach_in = 0.0, reach_out = 0.0;  ///< s, how long before and after the corner to look; longer is tighter
  double tolerance = 0.0;                  ///< m, >= 0
};

/// What a corner costs at least, as the multipliers of its linear program say it for all speeds.
struct CornerDual {
  double period = 0.0;          ///< s
  double sides = 0.0;           ///< the multipliers times the sides of their rows
  std::vector<double> in, out;  ///< the multipliers' part in every column: a leg's speed in one period over its highest
  /// Time lost, s, against both legs at their highest speeds, where these are `of_in` and `of_out` times those that the
  /// program was solved for. By weak duality valid for all of them; tight where it was solved, and along of_in =
  /// of_out. Below 0 where cutting the corner saves more than turning costs.
  double at(double of_in = 1.0, double of_out = 1.0) const;
};

/// A time that such a corner costs at least beside passing it at both speeds, whatever filters, delays and feeds: by
/// the dual of a linear program, whose multipliers are put into the bound here, so that nothing rests on the solver's
/// word.
///
/// Assumed of the motion: x = sum of u_i s_i with both s_i never falling and no faster than their highest speeds, the
/// two legs alone moving meanwhile, together no faster than the feed and at once only within the reach, the path within
/// the tolerance of the corner at one moment, the axes within their acceleration (force at rest included) and jerk
/// limits. Sampled so that this moment is a sample, its differences keep the limits and are linear in the speeds of the
/// legs; the ball of the tolerance is replaced by a polygon around it.
/// @param periods  in the reach; more are tighter
CornerDual corner_loss(const BoundCorner& corner, const Machine& machine, std::size_t dimensions, int periods);

/// A time that no sampled motion of a program undercuts, if it is one of those above, and on every leg that counts,
/// when it is fastest there, no other leg moves.
struct CornerBound {
  double time = 0.0;        ///< s
  std::size_t corners = 0;  ///< joints that turn
  std::size_t counted = 0;  ///< of these between legs longer than cutting their corners takes: the others cost nothing
  std::size_t classes = 0;  ///< linear programs solved
  bool complete = true;     ///< false after 400 programs or if time ran out: further corners cost nothing
};

/// For all highest speeds v_i of the legs i, sum of L_i/v_i + sum of what the corners cost at them, at its least; in
/// program_corner_bound.cpp.
///
/// At the moment of its highest speed v_i a leg has no acceleration, so that a motion cut there might go on at v_i and
/// lose nothing. Hence between two such moments a corner costs at least its loss at those speeds, and a program at
/// least the sum for the speeds that it comes to, which are unknown. They are sorted into steps: of a leg with v_i
/// between two of them the part may be replaced by one that speeds up to the upper step v first, which costs
/// (v - v_i) t/(2 v) each side, t the time this takes. So the sum is bounded for all speeds of a step at once, and the
/// least over all choices of steps is found by dynamic programming. From rest to v takes t in jerk-limited steps and
/// loses t/2; dwells count in full.
///
/// Samples at T stand for a continuous motion, the quadratic spline with them as coefficients (the cubic one where jerk
/// is limited): its second (third) derivatives are the differences of the samples, so it keeps all limits; it comes to
/// rest one (two) periods later, and leaves the polyline of the samples by no more than A T^2/8 (A T^2/6). So one (two)
/// periods are taken off for every section between stops, and the tolerances are widened by that.
/// @param machine  as many axes as the path  @param time_limit  s, for the linear programs
CornerBound program_corner_bound(const Toolpath& path, const Machine& machine, double sample_period, double time_limit);

/// The most that an axis may accelerate by at any speed up to its limit: friction helps to brake. m/s^2
double acceleration_most(const Axis& axis);

}  // namespace accdec
