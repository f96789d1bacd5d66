#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include <fmt/format.h>

#include <accdec/machine/response.hpp>
#include <accdec/plan/command/slow_blocks.hpp>
#include <accdec/plan/delays/joint_delays.hpp>
#include <accdec/plan/feeds/contour_feeds.hpp>
#include <accdec/task/blend_limits.hpp>

namespace accdec {
namespace {

enum class End { start, stop };

class FeedLimiter {
 public:
  FeedLimiter(Toolpath& path, const Filter& filter, double sample_period, const Machine& machine)
      : path_(path),
        filter_(filter),
        period_(sample_period),
        machine_(machine),
        limits_(filter, machine, sample_period),
        programmed_(path.duration),
        binding_(path.blocks()),
        by_control_(path.blocks(), 0),
        reach_((filter.order() + 2) * sample_period) {}

  /// Slows blocks that leave the contour at constant feed. True if anything was.
  bool slow_to_contour(const FilterBehind& behind, double sample_period) {
    bool slowed = false;
    for (std::size_t b = 0; const double part : hold_contour(path_, behind, sample_period)) {
      if (part < 1.0) binding_[b] = {LimitKind::contour, machine_.axes.size()}, slowed = true;
      ++b;
    }
    return slowed;
  }

  /// Slows blocks within `reach` of the rest before block b (start) or after it (stop), inside its leg. True if
  /// anything was.
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

  /// Slows the legs that meet at joint b, the faster one first, until the control has a delay with which they hold the
  /// limits. True if anything was.
  bool slow_to_wait(std::size_t b) {
    JointDelays joints(path_, filter_, period_, machine_);
    const double in = path_.length(b) / path_.duration[b], out = path_.length(b + 1) / path_.duration[b + 1];
    const auto factors = [&](double speed) {
      return std::array{std::min(1.0, speed / in), std::min(1.0, speed / out)};
    };
    const auto holds = [&](double speed) {
      const auto [before, behind] = factors(speed);
      path_.joint[b] == Joint::stop ? joints.stop(b, before, behind) : joints.corner(b, before, behind);
      return joints.take_possible();
    };
    double high = std::max(in, out), low = slowest * high;
    if (holds(high) || !holds(low)) return false;
    while (high - low > 1e-4 * low) {
      const double middle = 0.5 * (low + high);
      (holds(middle) ? low : high) = middle;
    }
    const auto [before, behind] = factors(low);
    std::size_t first = b, last = b + 1;
    while (first > 0 && !ends_leg(path_, first - 1)) --first;
    while (last + 1 < path_.blocks() && !ends_leg(path_, last)) ++last;
    for (std::size_t i = first; i <= last; ++i) {
      const double factor = i <= b ? before : behind;
      path_.duration[i] /= factor;
      if (factor < 1.0) by_control_[i] = 1;
    }
    return true;
  }

  /// Length of a filter plus one sample, s.
  double reach() const { return reach_; }

  /// Slows the faster block at every joint of the leg around joint b that its blocks cannot pass together, until the
  /// feed rises and falls in steps within the limits. True if anything was.
  bool ramp(std::size_t b) {
    std::size_t first = b, last = b;
    while (first > 0 && !ends_leg(path_, first - 1)) --first;
    last = leg_end(b);
    bool slowed = false;
    for (std::size_t i = first; i < last; ++i) slowed = slow_jump(i, i + 1) || slowed;
    for (std::size_t i = last; i > first; --i) slowed = slow_jump(i, i - 1) || slowed;
    return slowed;
  }

  /// The joint that ends the leg of block b.
  std::size_t leg_end(std::size_t b) const {
    while (!ends_leg(path_, b)) ++b;
    return b;
  }

  std::vector<SlowedFeeds> slowed() const {
    std::vector<SlowedFeeds> result;
    for (std::size_t b = 0; b < path_.blocks(); ++b) {
      if (path_.duration[b] <= programmed_[b]) continue;
      const auto& [kind, axis] = binding_[b];
      const bool of_axis = axis < machine_.axes.size();
      const std::string name =
          by_control_[b] != 0 ? "all limits with the control's delays"
                              : fmt::format("{}{}", to_string(kind), of_axis ? " " + machine_.axes[axis].name : "");
      auto entry =
          std::find_if(result.begin(), result.end(), [&](const SlowedFeeds& other) { return other.limit == name; });
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
  using Velocity = std::array<double, program_axis_count>;
  Velocity velocity(std::size_t b, double factor) const {
    Velocity v{};
    const double* p = path_.point(b);
    const std::size_t n = path_.dimensions();
    for (std::size_t i = 0; i < n; ++i) v[i] = factor * (p[n + i] - p[i]) / path_.duration[b];
    return v;
  }

  bool holds(std::size_t b, End end, double factor) const {
    const Velocity v = velocity(b, factor), rest{};
    return end == End::start ? limits_.holds(rest.data(), v.data(), 0) : limits_.holds(v.data(), rest.data(), 0);
  }

  /// Slows `changed` until the limits hold where it meets its neighbour `kept` at full overlap, but not below the
  /// neighbour's speed.
  bool slow_jump(std::size_t kept, std::size_t changed) {
    const auto passes = [&](double factor) {
      const Velocity a = velocity(kept, 1.0), c = velocity(changed, factor);
      const bool forward = kept < changed;
      return limits_.holds((forward ? a : c).data(), (forward ? c : a).data(), 0);
    };
    if (passes(1.0)) return false;
    const auto speed = [](const Velocity& v) {
      return std::sqrt(std::inner_product(v.begin(), v.end(), v.begin(), 0.0));
    };
    double low = speed(velocity(kept, 1.0)) / speed(velocity(changed, 1.0)), high = 1.0;
    if (!(low < 1.0) || !passes(low)) return false;
    while (high - low > 1e-4 * low) {
      const double middle = 0.5 * (low + high);
      (passes(middle) ? low : high) = middle;
    }
    // A limit that binds a jump binds a start, too: the name is for the report.
    limits_.start_factor(velocity(changed, 1.0).data(), &binding_[changed]);
    path_.duration[changed] /= low;
    return true;
  }

  bool slow_block(std::size_t b, End end) {
    if (holds(b, end, 1.0)) return false;
    // Sure, and with limits of velocity, acceleration and jerk exact; force and power may allow more, for their peaks
    // do not coincide.
    double low = limits_.start_factor(velocity(b, 1.0).data(), &binding_[b]), high = 1.0;
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

  static constexpr double slowest = 0.02;  ///< part of the feeds; below, no limit asks for less

  Toolpath& path_;
  const Filter& filter_;
  double period_;
  const Machine& machine_;
  BlendLimits limits_;
  const std::vector<double> programmed_;
  std::vector<BlendLimits::Binding> binding_;  // of every block
  std::vector<char> by_control_;               // of every block: whether its joint's delay asked for a lower feed
  double reach_;                               // s
};

}  // namespace

std::vector<SlowedFeeds> limit_feeds(Toolpath& path, const Filter& filter, double sample_period, const Machine& machine,
                                     PairwiseDelays& delays, bool ramps, const Deadline& deadline) {
  if (machine.axes.empty()) return {};
  FeedLimiter limiter(path, filter, sample_period, machine);
  if (limiter.slow_to_contour(FilterBehind(filter, machine, sample_period), sample_period))
    delays = pairwise_delays(path, filter, sample_period, machine);
  // A shorter reach at a lower feed may leave the next block out, and legs that meet slower make others meet faster: a
  // few rounds. If ramps do not settle it, whole legs are slowed in the end.
  for (int round = 0; round < 12 && !deadline.over(); ++round) {
    bool slowed = limiter.slow(0, End::start, limiter.reach());
    slowed = limiter.slow(path.blocks() - 1, End::stop, limiter.reach()) || slowed;
    const double reach = round < 8 ? limiter.reach() : std::numeric_limits<double>::infinity();
    std::size_t settled = 0;  // joints of a leg before it: another ramp changes nothing
    for (const std::size_t b : delays.impossible) {
      if (deadline.over()) break;
      // Inside a leg the feed need not fall to that of a stop: only its step must hold.
      if (ramps && round < 8 && !ends_leg(path, b)) {
        if (b >= settled && !limiter.ramp(b))
          settled = limiter.leg_end(b);
        else
          slowed = slowed || b >= settled;
        continue;
      }
      slowed = limiter.slow(b, End::stop, reach) || slowed;
      slowed = limiter.slow(b + 1, End::start, reach) || slowed;
      if (ends_leg(path, b) && !path.control.any()) slowed = limiter.slow_to_wait(b) || slowed;
    }
    if (!slowed) break;
    delays = pairwise_delays(path, filter, sample_period, machine);
  }
  return limiter.slowed();
}

}  // namespace accdec
