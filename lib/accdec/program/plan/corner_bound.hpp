#pragma once

#include <cstddef>

#include <accdec/machine/machine.hpp>
#include <accdec/program/read/toolpath.hpp>

namespace accdec {

/// A corner of two straight legs, each at its feed before and after.
struct BoundCorner {
  const double* in = nullptr;              ///< unit vectors, one value an axis
  const double* out = nullptr;             ///< see `in`
  double feed_in = 0.0, feed_out = 0.0;    ///< m/s, > 0
  double reach_in = 0.0, reach_out = 0.0;  ///< s, how long before and after the corner to look; longer is tighter
  double tolerance = 0.0;                  ///< m, >= 0
};

/// A time that such a corner costs at least beside passing it at both feeds, s, >= 0, whatever filters, delays and
/// feeds: by the dual of a linear program, whose multipliers are put into the bound here, so that nothing rests on
/// the solver's word.
///
/// Assumed of the motion: x = sum of u_i s_i with both s_i never falling and no faster than the feed, the two legs
/// alone moving meanwhile, together no faster than the higher feed and at once only within the reach, the path within
/// the tolerance of the corner at one moment, the axes within their acceleration (force at rest included) and jerk
/// limits. Sampled so that this moment is a sample, its differences keep the limits and are linear in the speeds of the
/// legs; the ball of the tolerance is replaced by a polygon around it.
double corner_time_bound(const BoundCorner& corner, const Machine& machine, std::size_t dimensions,
                         double sample_period);

/// A time that no motion of a program undercuts, if on the legs that count it comes to its feed somewhere between their
/// corners and no three legs move at once.
struct CornerBound {
  double time = 0.0;        ///< s
  std::size_t corners = 0;  ///< joints that turn
  std::size_t counted = 0;  ///< of these between legs long enough to come to their feeds: the others cost nothing here
  std::size_t classes = 0;  ///< linear programs solved
  bool complete = true;     ///< false if time ran out: further classes of corners cost nothing
};

/// Way over feed of every block, the corner bounds of every joint whose two legs are long enough to go from rest to
/// their feed and back (solved once for all corners of the same directions, feeds and tolerance), starts and stops of
/// such legs, and dwells.
/// @param machine  as many axes as the path  @param time_limit  s, for the linear programs
CornerBound program_corner_bound(const Toolpath& path, const Machine& machine, double sample_period, double time_limit);

}  // namespace accdec
