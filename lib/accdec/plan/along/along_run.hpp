#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <accdec/files.hpp>
#include <accdec/plan/free/free_path.hpp>

namespace accdec {

/// A motion along blocks first .. last, from rest to rest.
struct AlongRun {
  std::vector<double> position;  ///< rows, m, from the first sample after the start to that at the end
  std::vector<double> passes;    ///< of the joints inside, samples after the start
};

/// The fastest motion along lines, the arcs themselves and smooth curves through the chords of splines, with limits
/// axis by axis, see PathSpeed. It keeps feeds, velocity, acceleration, jerk, force and the tolerances of joints. Its
/// samples stay in the tube of the chords.
/// @param free  limits of power and regeneration are not kept
/// @param most  samples of the motion that there is: the search ends as soon as it finds that it will take longer
/// @param deadline  ends it with the motion that it has come to
/// @returns none without arcs and splines, with a stop or a joint inside that grants nothing, or if limits leave no
///          motion
std::optional<AlongRun> along_run(const FreePath& free, std::size_t first, std::size_t last, std::size_t most,
                                  const Deadline& deadline);

/// The same motion with its runs between stops along the path wherever that is faster. In with_runs_along.cpp.
FreeSamples with_runs_along(const FreePath& free, const FreeSamples& motion, const Deadline& deadline);

/// The part of the limits that motions along a path use: the rest is for rounding.
inline constexpr double of_limits = 1.0 - 1e-6;

/// The smallest tolerance of a joint that is passed without a stop, m.
inline constexpr double least_tolerance = 1e-8;

}  // namespace accdec
