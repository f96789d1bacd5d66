#include <algorithm>
#include <cmath>

#include <accdec/plan/along/along_run.hpp>

namespace accdec {
namespace {

constexpr double at_point = 1e-9;  // m

/// Puts a motion together, run by run, from another and from runs along the path.
class Joining {
 public:
  Joining(const FreePath& free, const FreeSamples& motion) : free_(free), motion_(motion), n_(free.dimensions()) {
    result_.position.assign(motion.position.begin(), motion.position.begin() + static_cast<std::ptrdiff_t>(n_));
  }

  FreeSamples run(const Deadline& deadline) {
    std::size_t first = 0;
    for (std::size_t b = 0; b < free_.path.blocks(); ++b) {
      if (!stops(b)) continue;
      take(first, b, deadline);
      first = b + 1;
    }
    return std::move(result_);
  }

 private:
  bool at(std::size_t sample, std::size_t point) const {
    double most = 0.0;
    for (std::size_t a = 0; a < n_; ++a)
      most = std::max(most, std::abs(motion_.position[sample * n_ + a] - free_.path.point(point)[a]));
    return most <= at_point;
  }
  /// Whether the motion rests at the end of a block on a sample.
  bool stops(std::size_t b) const {
    if (b + 1 == free_.path.blocks()) return true;
    const bool exact = free_.path.joint[b] != Joint::straight && free_.path.tolerance[b] < least_tolerance;
    if (free_.path.joint[b] != Joint::stop && !exact) return false;
    const double pass = motion_.passes[b];
    return std::abs(pass - std::round(pass)) < 1e-6 && at(static_cast<std::size_t>(std::lround(pass)), b + 1);
  }
  /// Blocks first .. last.
  void take(std::size_t first, std::size_t last, const Deadline& deadline) {
    const std::size_t begin = next_;
    const std::size_t end = last + 1 == free_.path.blocks()
                                ? motion_.count(n_) - 1
                                : static_cast<std::size_t>(std::lround(motion_.passes[last]));
    next_ = end;
    const std::optional<AlongRun> along = deadline.over() ? std::nullopt : along_run(free_, first, last, deadline);
    const std::size_t rest = along ? rests(begin, end, first) : 0;
    const auto now = static_cast<double>(result_.count(n_) - 1);
    if (along && rest + along->position.size() / n_ < end - begin) {
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
      while (k + 1 < end && at(k + 1, 0)) ++k;
      return free_.path.dwell_first > 0.0 ? k - begin : 0;
    }
    double time = 0.0;
    for (const auto& [block, dwell] : free_.path.dwell) time += block + 1 == first ? dwell : 0.0;
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
