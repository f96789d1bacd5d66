#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include <accdec/plan/along/along_run.hpp>

namespace accdec {

/// Blocks along one straight line.
struct StraightLeg {
  double length = 0.0, feed = unlimited;  ///< m, m/s: the lowest of the blocks
  std::array<double, program_axis_count> direction{};
};
/// @returns none if a joint inside turns, or without a length
std::optional<StraightLeg> straight_leg(const FreePath& free, std::size_t first, std::size_t last);

/// @param done  part of the way along a straight leg, of every sample, from 0 to 1
AlongRun on_line(const FreePath& free, std::size_t first, std::size_t last, const std::vector<double>& done);

/// The fastest motion along one straight line of blocks first .. last, from rest to rest in a whole number of samples.
/// Its feed is the lowest of the blocks. Limits of acceleration, force and jerk are constant along the line, so the
/// optimum is known. The speed rises, stays and falls by the same ramp, whose acceleration is a trapezoid.
/// @param free  limits of power and regeneration are not kept
/// @returns none if a joint inside turns, or if limits leave no motion
std::optional<AlongRun> straight_run(const FreePath& free, std::size_t first, std::size_t last);

/// The same motion with its straight runs between stops replaced wherever that is faster. A filter makes all legs with
/// ramps of one length; each leg by itself has the ramp that suits its length. In with_runs_along.cpp.
FreeSamples with_straight_runs(const FreePath& free, const FreeSamples& motion);

/// The same motion with its straight legs between stops in the least numbers of samples, one after another, by linear
/// programs over their samples. The differences of samples are means of what a motion does between them. So a leg may
/// take two samples less than in continuous time. Friction helps to brake. In with_shortest_legs.cpp.
/// @param deadline  ends it; what is left stays as it is
FreeSamples with_shortest_legs(const FreePath& free, const FreeSamples& motion, const Deadline& deadline);

}  // namespace accdec
