#include <algorithm>
#include <cmath>

#include <accdec/plan/along/along_run.hpp>
#include <accdec/plan/along/stop_runs.hpp>

namespace accdec {
namespace {

constexpr double near_rest = 1e-9, at_rest = 1e-12;  // m
constexpr double rounding = 1e-14;                   // m, of a position at rest

class Cutting {
 public:
  Cutting(const FreePath& free, const FreeSamples& motion)
      : free_(free), motion_(motion), n_(free.dimensions()), last_move_(last_move(free, motion)) {}

  std::vector<StopRun> run() {
    std::size_t first = 0;
    for (std::size_t b = 0; b < free_.path.blocks(); ++b) {
      const std::size_t end = stop_at(b);
      if (end == 0) continue;
      add(first, b, end);
      first = b + 1;
    }
    return std::move(runs_);
  }

 private:
  /// m, of a sample from a point.
  double distance(std::size_t sample, std::size_t point) const {
    double sum = 0.0;
    for (std::size_t a = 0; a < n_; ++a)
      sum = std::hypot(sum, motion_.position[sample * n_ + a] - free_.path.point(point)[a]);
    return sum;
  }
  /// The sample at which the motion rests at the end of a block; 0: it does not. Behind a last filter it comes to rest
  /// slowly.
  std::size_t stop_at(std::size_t b) const {
    if (b + 1 == free_.path.blocks()) return last_move_;
    const bool exact = free_.path.joint[b] != Joint::straight && free_.path.tolerance[b] < least_tolerance;
    if (free_.path.joint[b] != Joint::stop && !exact) return 0;
    std::size_t best = 0;
    double least = at_rest;
    for (auto k = static_cast<std::size_t>(std::ceil(motion_.passes[b] - 1e-6));
         k < last_move_ && distance(k, b + 1) <= near_rest; ++k) {
      if (distance(k, b + 1) > least - rounding) continue;
      least = distance(k, b + 1);
      best = k;
    }
    return best;
  }
  /// At whose end the motion rests at sample `end`.
  void add(std::size_t first, std::size_t last, std::size_t end) {
    StopRun run{first, last, runs_.empty() ? 0 : runs_.back().end, end};
    while (run.begin + run.still + 1 < end && distance(run.begin + run.still + 1, first) <= at_rest) ++run.still;
    run.rest = std::min(rests(run), end - run.begin);
    runs_.push_back(run);
  }
  /// Samples to rest for before the first block of a run.
  std::size_t rests(const StopRun& run) const {
    if (run.first > 0) return free_.rests_at(run.first - 1);
    std::size_t k = run.begin;
    while (k + 1 < run.end && distance(k + 1, 0) <= at_rest) ++k;
    return free_.path.dwell_first > 0.0 ? k - run.begin : 0;
  }

  const FreePath& free_;
  const FreeSamples& motion_;
  const std::size_t n_, last_move_;
  std::vector<StopRun> runs_;
};

}  // namespace

std::size_t last_move(const FreePath& free, const FreeSamples& motion) {
  return motion.count(free.dimensions()) - 1 - free.rests_at(free.path.blocks() - 1);
}

std::vector<StopRun> stop_runs(const FreePath& free, const FreeSamples& motion) {
  return Cutting(free, motion).run();
}

}  // namespace accdec
