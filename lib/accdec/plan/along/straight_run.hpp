#pragma once

#include <cstddef>
#include <optional>

#include <accdec/plan/along/along_run.hpp>

namespace accdec {

/// The fastest motion along one straight line of blocks first .. last, from rest to rest in a whole number of samples.
/// Its feed is the lowest of the blocks. Limits of acceleration, force and jerk are constant along the line, so the
/// optimum is known. The speed rises, stays and falls by the same ramp, whose acceleration is a trapezoid.
/// @param free  limits of power and regeneration are not kept
/// @returns none if a joint inside turns, or if limits leave no motion
std::optional<AlongRun> straight_run(const FreePath& free, std::size_t first, std::size_t last);

/// The same motion with its straight runs between stops replaced wherever that is faster. A filter makes all legs with
/// ramps of one length; each leg by itself has the ramp that suits its length.
FreeSamples with_straight_runs(const FreePath& free, const FreeSamples& motion);

}  // namespace accdec
