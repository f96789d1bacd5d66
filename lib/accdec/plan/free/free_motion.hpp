#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <accdec/files.hpp>
#include <accdec/plan/free/free_path.hpp>
#include <accdec/program.hpp>
#include <accdec/simulate.hpp>

namespace accdec {

/// The work that was done.
struct FreeReport {
  int sweeps = 0;
  std::int64_t programmes = 0, iterations = 0;
  bool ended = false;  ///< by the deadline
};

/// A motion of profiles as samples, with the passes of its joints. In sampled.cpp.
FreeSamples sampled(const Toolpath& path, const Trajectory& trajectory, double sample_period);

/// As above, of a plan of one filter. None if its path is not that one with steps of feed, as where arcs were read
/// again.
std::optional<FreeSamples> sampled(const Toolpath& path, const Plan& fixed, double sample_period);

/// Shortens a motion that holds all limits by convex programs over windows of its samples, see window.hpp. Each part
/// of it is shortened by itself; every state is a motion from rest to rest.
/// @param deadline  ends it with the best motion so far
FreeReport shorten_motion(const FreePath& free, FreeSamples& motion, const FreeOptions& options,
                          const Deadline& deadline);

}  // namespace accdec
