#include <algorithm>
#include <cmath>

#include <accdec/plan/along/along_run.hpp>

namespace accdec {
namespace {

constexpr double near_rest = 1e-9, at_rest = 1e-12;  // m

/// Puts a motion together, run by run, from another and from runs along the path.
class Joining {
 public:
  Joining(const FreePath& free, const FreeSamples& motion) : free_(free), motion_(motion), n_(free.dimensions()) {
    result_.position.assign(motion.position.begin(), motion.position.begin() + static_cast<std::ptrdiff_t>(n_));
  }

  FreeSamples run(const Deadline& deadline) {
    std::size_t first = 0;
    for (std::size_t b = 0; b < free_.path.blocks(); ++b) {
      const std::size_t end = stop_at(b);
      if (end == 0) continue;
      take(first, b, end, deadline);
      first = b + 1;
    }
    return std::move(result_);
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
    const std::size_t last = motion_.count(n_) - 1;
    if (b + 1 == free_.path.blocks()) return last;
    const bool exact = free_.path.joint[b] != Joint::straight && free_.path.tolerance[b] < least_tolerance;
    if (free_.path.joint[b] != Joint::stop && !exact) return 0;
    std::size_t best = 0;
    double least = at_rest;
    for (auto k = static_cast<std::size_t>(std::ceil(motion_.passes[b] - 1e-6));
         k < last && distance(k, b + 1) <= near_rest; ++k) {
      if (distance(k, b + 1) >= least) continue;
      least = distance(k, b + 1);
      best = k;
    }
    return best;
  }
  /// Blocks first .. last, at whose end the motion rests at sample `end`.
  void take(std::size_t first, std::size_t last, std::size_t end, const Deadline& deadline) {
    const std::size_t begin = next_;
    next_ = end;
    const std::size_t rest = rests(begin, end, first), most = end - begin - std::min(rest, end - begin);
    std::optional<AlongRun> along;
    if (!deadline.over()) along = along_run(free_, first, last, most, deadline);
    const auto now = static_cast<double>(result_.count(n_) - 1);
    if (along && along->position.size() / n_ < most) {
      for (std::size_t i = 0; i < rest; ++i)
        result_.position.insert(result_.position.end(), free_.path.point(first), free_.path.point(first) + n_);
      result_.position.insert(result_.position.end(), along->position.begin(), along->position.end());
      for (const double pass : along->passes) result_.passes.push_back(now + static_cast<double>(rest) + pass);
    } else {
      result_.position.insert(result_.position.end(),
                              motion_.position.begin() + static_cast<std::ptrdiff_t>((begin + 1) * n_),
                              motion_.position.begin() + static_cast<std::ptrdiff_t>((end + 1) * n_));
      for (std::size_t b = first; b < last; ++b)
        result_.passes.push_back(motion_.passes[b] - static_cast<double>(begin) + now);
    }
    if (last + 1 < free_.path.blocks()) result_.passes.push_back(static_cast<double>(result_.count(n_) - 1));
  }
  /// Samples to rest for before the first block of a run.
  std::size_t rests(std::size_t begin, std::size_t end, std::size_t first) const {
    if (first == 0) {
      std::size_t k = begin;
      while (k + 1 < end && distance(k + 1, 0) <= at_rest) ++k;
      return free_.path.dwell_first > 0.0 ? k - begin : 0;
    }
    double time = 0.0;
    for (const auto& [block, dwell] : free_.path.dwells_at(first - 1)) time += dwell;
    return static_cast<std::size_t>(std::ceil(time / free_.period - 1e-9));
  }

  const FreePath& free_;
  const FreeSamples& motion_;
  const std::size_t n_;
  std::size_t next_ = 0;  // sample of the motion where the next run begins
  FreeSamples result_;
};

}  // namespace

FreeSamples with_runs_along(const FreePath& free, const FreeSamples& motion, const Deadline& deadline) {
  return Joining(free, motion).run(deadline);
}

}  // namespace accdec
