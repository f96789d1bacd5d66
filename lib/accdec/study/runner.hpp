#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include <accdec/study/journal.hpp>

namespace accdec::study {

/// Where points are computed.
enum class Isolation {
  threads,   ///< oneTBB in this process: for methods that are safe to run side by side
  processes  ///< one child a worker: for libraries that are not, and so that a crash costs one point only
};

struct RunOptions {
  int workers = 0;  ///< 0: as many as there are cores
  Isolation isolation = Isolation::threads;
  double kill_after = 0.0;  ///< s a point may take in a child before it is killed and recorded as failed; 0: no limit
  std::function<double(std::size_t)> kill_after_of = {};  ///< the same by point, instead of `kill_after`, if not empty
  bool fresh_children = false;  ///< a child for every point, so that none can leave anything behind for the next
};

/// Computes points, in no particular order, and hands each to `done` as soon as it is there; `done` is never called
/// twice at once. Results depend on the index alone, never on the number of workers.
/// @param compute  index -> row; called from many threads or in children; what it throws ends the run (or, in a child,
/// the point)
/// @param lost     index, reason -> row of a point whose child died or was killed
void run_points(const std::vector<std::size_t>& indices, const std::function<std::string(std::size_t)>& compute,
                const std::function<std::string(std::size_t, const std::string&)>& lost,
                const std::function<void(std::size_t, const Entry&)>& done, const RunOptions& options = {});

/// Number of workers that RunOptions::workers means.
int workers_of(const RunOptions& options);

}  // namespace accdec::study
