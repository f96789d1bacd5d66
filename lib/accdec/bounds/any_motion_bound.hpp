#pragma once

#include <accdec/machine.hpp>
#include <accdec/simulate.hpp>

namespace accdec {

/// A time that no motion of a program undercuts, whatever plans it.
struct AnyMotionBound {
  double time = 0.0;     ///< s
  bool complete = true;  ///< false if linear programs or time ran out: what was left counts as if it cost nothing
};

/// Other than corner_bound, this bound does not ask how a motion is made: it may swing out before a corner, and its
/// axes need not be monotone.
///
/// The motion rests at both ends and at stops. It passes every other joint within its tolerance. Between two joints it
/// stays as near to their leg as the larger of their tolerances (0 at stops). It is no faster than the programmed feed,
/// near a joint than the higher feed of both. The axes keep their velocity, acceleration (force at rest) and jerk
/// limits.
///
/// Legs of an arc are its chords; a motion may be as near to the arc itself instead. So it may run inside the arc by
/// its tolerance, which every joint of two chords saves its part of. Chords are those of the path: a plan that read its
/// arcs again has another bound.
///
/// Let c be the pace of a leg, a vector with c . x' <= 1 for all velocities allowed: direction over feed, or for a
/// rapid move 1/v_max along the axis that needs longest. The time from one joint to the next is
///   c . (x(t2) - x(t1)) + integral of (1 - c . x') dt,
/// and nothing is negative in the integral. So a program takes at least the way of every leg at its pace, and at every
/// corner the loss in a window of time around it. Windows must not overlap. A linear program with both ends of the
/// window free bounds the loss (tube_loss). A leg takes at least its way at its pace and the losses at both its ends,
/// each by itself. Windows of that length do not overlap; they are widened until that brings nothing more. The result
/// is never below program_lower_bound, which lets a motion be anywhere between the joints.
///
/// If corners are close, a motion never reaches the feed, and the pace counts too little. There weight_bound is larger,
/// which sees all corners together. On fine chords the time that axes need to go back and forth may be, see
/// window_bound, or kernel_bound if acceleration and jerk limit the motion all the time.
///
/// Samples at T stand for a continuous motion, as in corner_bound. So one period (two with a jerk limit) is taken off
/// for every section between stops, and tolerances are widened.
/// @param machine  its axes are found by their names (program_machine)  @param time_limit  s, for the linear programs
/// @param thorough  whether weight_bound and kernel_bound may take seconds, else a fraction of one
AnyMotionBound any_motion_bound(const Toolpath& path, const Machine& machine, double sample_period, double time_limit,
                                bool thorough = true);

}  // namespace accdec
