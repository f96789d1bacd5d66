#pragma once

#include <accdec/files.hpp>
#include <accdec/machine.hpp>
#include <accdec/program.hpp>
#include <accdec/simulate.hpp>

namespace accdec {

/// A time that no motion of a program undercuts, whatever plans it.
struct AnyMotionBound {
  double time = 0.0;     ///< s
  bool complete = true;  ///< false if linear programs or time ran out: what was left counts as if it cost nothing
  std::vector<MotionProof> proofs{};  ///< of a bound that is not larger, if it was thorough
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
/// its tolerance, which every joint of two chords saves its part of.
///
/// The largest of several bounds counts, section by section between stops. Each window has the larger loss of those
/// with and without the jerk limits. Stops end windows, so passing them is tried, too.
///
/// THEORY.md has the derivation: "Paces and losses", and "Samples and continuous motion".
/// @param machine  its axes are found by their names (program_machine)  @param deadline  for the linear programs
/// @param thorough  whether weight_bound and kernel_bound may take seconds, else a fraction of one
AnyMotionBound any_motion_bound(const Toolpath& path, const Machine& machine, double sample_period,
                                const Deadline& deadline, bool thorough = true);

}  // namespace accdec
