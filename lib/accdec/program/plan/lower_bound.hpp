#pragma once

#include <accdec/machine/machine.hpp>
#include <accdec/program/read/toolpath.hpp>

namespace accdec {

/// A time that no time-continuous motion of a program undercuts, whatever plans it, s. Sampled motion, whose first
/// sample already moves, may be shorter by one sample period for every section between stops.
///
/// Assumed of the motion: no faster than the programmed feed, within the velocity and acceleration limits of the axes,
/// at rest at the beginning, the end and at stops, through every other joint within its tolerance. Then
/// - the way between the tolerance balls of a block's ends is at least L - e1 - e2, and takes that over its feed;
/// - from rest, the speed after t is at most A t, A the length of the vector of the axes' accelerations (or, for a
/// single block between
///   stops, which is straight, what the axes allow in its direction): each start and stop costs v/(2 A) more, v the
///   feed there.
/// - of windows of several blocks, the way and what turning takes: window_bound.
/// Dwells count in full. Weak where corners cost much, between legs longer than it takes to turn: see corner_bound.
/// Samples that keep to a tolerance by the polyline through them stand for a motion that uses A T^2/8 more of it.
/// @param machine  as many axes as the path, or without axes
double program_lower_bound(const Toolpath& path, const Machine& machine);

}  // namespace accdec
