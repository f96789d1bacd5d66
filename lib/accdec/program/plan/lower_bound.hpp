#pragma once

#include <accdec/machine/machine.hpp>
#include <accdec/program/read/toolpath.hpp>

namespace accdec {

/// A time that no sampled motion of a program undercuts, whatever plans it, s; with a sample period of 0, no
/// time-continuous one.
///
/// Assumed of the motion: no faster than the programmed feed, within the velocity and acceleration limits of the axes,
/// at rest at the beginning, the end and at stops, through every other joint within its tolerance. Then
/// - the way between the tolerance balls of a block's ends is at least L - e1 - e2, and takes that over its feed;
/// - from rest, the speed after t is at most A t, A the length of the vector of the axes' accelerations (or, for a
///   single block between stops, which is straight, what the axes allow in its direction): each start and stop costs
///   v/(2 A) more, v the feed there.
/// - of windows of several blocks, the way and what turning takes: window_bound.
/// Dwells count in full. Weak where corners cost much, between legs longer than it takes to turn: see corner_bound.
///
/// Samples at T stand for a continuous motion, the quadratic spline with them as coefficients: its second derivatives
/// are the differences of the samples, so it keeps their limits, comes to rest one period later and leaves the polyline
/// through them by no more than A T^2/8. So where accelerations are used, one period is taken off for every section
/// between stops, and the tolerances are wider by that. The way over the feed holds for the polyline itself.
/// @param machine  as many axes as the path, or without axes; where one of them has no limit on its acceleration, those
/// of the others are not used
double program_lower_bound(const Toolpath& path, const Machine& machine, double sample_period);

}  // namespace accdec
