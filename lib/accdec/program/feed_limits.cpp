#include <algorithm>
#include <array>
#include <limits>

#include <fmt/format.h>

#include <accdec/program/corner_limits.hpp>
#include <accdec/program/plan.hpp>

namespace accdec {
namespace {

enum class End { start, stop };

class FeedLimiter {
 public:
  FeedLimiter(Toolpath& path, const LegFilters& filters, double sample_period, const Machine& machine)
      : path_(path),
        filters_(filters),
        machine_(machine),
        limits_(filters, machine, sample_period),
        programmed_(path.duration),
        binding_(path.blocks()),
        reach_((filters.order_max() + 2) * sample_period) {}

  /// Slows what lies within `reach` of the rest before block b (start) or after it (stop), inside its leg. True if anything was.
  /// @param reach  s
  bool slow(std::size_t b, End end, double reach) {
    bool slowed = false;
    for (double time = 0.0; time < reach; end == End::start ? ++b : --b) {
      slowed = slow_block(b, end) || slowed;
      time += path_.duration[b];
      if (end == End::start ? ends_leg(path_, b) : b == 0 || ends_leg(path_, b - 1)) break;
    }
    return slowed;
  }

  /// What a filter lasts, and a sample, s.
  double reach() const { return reach_; }

  std::vector<SlowedFeeds> slowed() const {
    std::vector<SlowedFeeds> result;
    for (std::size_t b = 0; b < path_.blocks(); ++b) {
      if (path_.duration[b] <= programmed_[b]) continue;
      const auto& [kind, axis] = binding_[b];
      const std::string name = fmt::format("{} {}", to_string(kind), machine_.axes[axis].name);
      auto entry = std::find_if(result.begin(), result.end(), [&](const SlowedFeeds& other) { return other.limit == name; });
      if (entry == result.end()) {
        result.push_back({name, 0, 1.0, 0});
        entry = result.end() - 1;
      }
      ++entry->blocks;
      const double factor = programmed_[b] / path_.duration[b];
      if (factor >= entry->factor) continue;
      entry->factor = factor;
      entry->line = path_.line[b];
    }
    return result;
  }

 private:
  bool holds(std::size_t b, End end, double factor) const {
    const std::size_t n = path_.dimensions();
    const double* p = path_.point(b);
    std::array<double, program_axis_count> velocity{};
    const std::array<double, program_axis_count> rest{};
    for (std::size_t i = 0; i < n; ++i) velocity[i] = factor * (p[n + i] - p[i]) / path_.duration[b];
    const Filter& filter = filters_.of(b);
    return end == End::start ? limits_.holds(filter, filter, rest.data(), velocity.data(), 0)
                             : limits_.holds(filter, filter, velocity.data(), rest.data(), 0);
  }

  bool slow_block(std::size_t b, End end) {
    if (holds(b, end, 1.0)) return false;
    const std::size_t n = path_.dimensions();
    const double* p = path_.point(b);
    std::array<double, program_axis_count> velocity{};
    for (std::size_t i = 0; i < n; ++i) velocity[i] = (p[n + i] - p[i]) / path_.duration[b];
    // Sure, and with limits of velocity, acceleration and jerk exact; force and power may allow more, for their peaks do not coincide.
    double low = limits_.start_factor(filters_.index(b), velocity.data(), &binding_[b]), high = 1.0;
    if (holds(b, end, std::min(1.0, low * 1.001))) {
      while (high - low > 1e-4 * low) {
        const double middle = 0.5 * (low + high);
        (holds(b, end, middle) ? low : high) = middle;
      }
    }
    if (!(low < 1.0 && low > 0.0)) return false;
    path_.duration[b] /= low;
    return true;
  }

  Toolpath& path_;
  const LegFilters& filters_;
  const Machine& machine_;
  CornerLimits limits_;
  const std::vector<double> programmed_;
  std::vector<CornerLimits::Binding> binding_;  // of every block
  double reach_;                                // s
};

}  // namespace

std::vector<SlowedFeeds> limit_feeds(Toolpath& path, const LegFilters& filters, double sample_period, const Machine& machine,
                                     PairwiseDelays& delays) {
  if (machine.axes.empty()) return {};
  FeedLimiter limiter(path, filters, sample_period, machine);
  // A shorter reach at a lower feed may leave the next block out, and legs that meet slower make others meet faster: a few rounds.
  // After these, whole legs: where one block is slowed to less than its neighbour can jump to, the next joint breaks the limit, and so on
  // block by block.
  for (int round = 0; round < 12; ++round) {
    bool slowed = limiter.slow(0, End::start, limiter.reach());
    slowed = limiter.slow(path.blocks() - 1, End::stop, limiter.reach()) || slowed;
    const double reach = round < 8 ? limiter.reach() : std::numeric_limits<double>::infinity();
    for (const std::size_t b : delays.impossible) {
      slowed = limiter.slow(b, End::stop, reach) || slowed;
      slowed = limiter.slow(b + 1, End::start, reach) || slowed;
    }
    if (!slowed) break;
    delays = pairwise_delays(path, filters, sample_period, machine);
  }
  return limiter.slowed();
}

}  // namespace accdec
