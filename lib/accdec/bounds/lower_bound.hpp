#pragma once

#include <accdec/machine.hpp>
#include <accdec/simulate.hpp>

namespace accdec {

/// A lower bound in s on the time of any sampled motion of a program by any planner. With a sample period of 0 it holds
/// for continuous motion.
///
/// Assumptions about the motion: it is not faster than the programmed feed and within the velocity and acceleration
/// limits of the axes. It rests at the beginning, the end and at stops, and passes every other joint within its
/// tolerance. There are three bounds:
/// - The distance between the tolerance balls of a block's ends is at least L - e1 - e2. It takes at least this over
/// the
///   feed.
/// - From rest, the speed after t is at most A t, where A is the length of the vector of the axes' accelerations. For a
///   single straight block between stops, A is what the axes allow in its direction. So each start and stop costs
///   v/(2 A) more, where v is the feed there.
/// - Windows of several blocks take their distance and the time for turning: window_bound.
///
/// Dwells count fully. The bound is weak where corners cost much, between legs that are longer than turning takes: see
/// corner_bound.
///
/// With accelerations, samples stand for a continuous motion: see THEORY.md, "Samples and continuous motion".
/// The bound by distance over feed holds for the polyline itself.
/// @param machine  its axes are found by their names (program_machine); where an axis of the path has no limit on its
/// acceleration, those of the others are not used
double program_lower_bound(const Toolpath& path, const Machine& machine, double sample_period);

}  // namespace accdec
