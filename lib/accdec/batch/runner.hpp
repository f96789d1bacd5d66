#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include <accdec/batch/journal.hpp>

namespace accdec::batch {

/// Points are computed in threads or in processes.
enum class Isolation {
  threads,   ///< oneTBB in this process: for methods that are safe to run side by side
  processes  ///< one child per worker: for libraries that are not, and so that a crash costs only one point
};

struct Progress {
  std::size_t done = 0, total = 0;  ///< number of points that this run must compute
  double seconds = 0.0;             ///< since it began
};

struct RunOptions {
  int workers = 0;  ///< 0: one per core
  Isolation isolation = Isolation::threads;
  double kill_after = 0.0;  ///< s, time limit of a point in a child; then it is killed and recorded as failed; 0: no
                            ///< limit 0: no limit
  std::function<double(std::size_t)> kill_after_of = {};  ///< the same for each point, instead of `kill_after`, if not
                                                          ///< empty
  bool fresh_children = false;  ///< a child for every point, so that no point affects the next
};

/// Computes points in any order, and passes each to `done` at once. Calls of `done` never overlap. Results depend on
/// the index alone, never on the number of workers.
/// @param compute  index -> row; called from many threads or in children; an exception ends the run (or, in a child,
/// the point)
/// @param lost  index, reason -> row; for a point whose child died or was killed
void run_points(const std::vector<std::size_t>& indices, const std::function<std::string(std::size_t)>& compute,
                const std::function<std::string(std::size_t, const std::string&)>& lost,
                const std::function<void(std::size_t, const Entry&)>& done, const RunOptions& options = {});

/// Number of workers that RunOptions::workers means.
int workers_of(const RunOptions& options);

}  // namespace accdec::batch
