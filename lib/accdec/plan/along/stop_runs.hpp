#pragma once

#include <cstddef>
#include <vector>

#include <accdec/plan/free/free_path.hpp>

namespace accdec {

/// Blocks first .. last of a motion, from rest to rest: samples begin .. end.
struct StopRun {
  std::size_t first = 0, last = 0, begin = 0, end = 0;
  std::size_t rest = 0, still = 0;  ///< samples before the first move: of dwells, and of the motion
};

/// The sample that ends the last move of a motion; a dwell may follow.
std::size_t last_move(const FreePath& free, const FreeSamples& motion);

/// A motion cut where it rests in a stop, or in a joint that grants nothing.
std::vector<StopRun> stop_runs(const FreePath& free, const FreeSamples& motion);

}  // namespace accdec
