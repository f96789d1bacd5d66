#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <accdec/certificate/member_limits.hpp>
#include <accdec/certificate/refuted_outlines.hpp>
#include <accdec/machine/limits.hpp>

namespace accdec {
namespace {

/// More than rounding.
constexpr double surely = 1.0 + 1e-9;

/// |sum_i b_i turn^(N - i)|
double left_behind(const std::vector<double>& taps, std::complex<double> turn) {
  std::complex<double> sum = 0.0;
  for (const double tap : taps) sum = sum * turn + tap;
  return std::abs(sum);
}

}  // namespace

RefutedOutlines::RefutedOutlines(const Task& granted, const CheckedResponse& response, int order_end)
    : period_(granted.sample_period), tap_max_(std::numeric_limits<double>::infinity()), step_max_(tap_max_) {
  const double period = period_;
  // Behind a smoothing taps and their differences are smaller.
  const bool smoothed = response.smoothing().size() > 1;
  for (std::size_t x = 0; x < granted.machine.axes.size(); ++x) {
    const Axis& axis = granted.machine.axes[x];
    double speed = 0.0;
    for (const TaskCorner& corner : granted.corners) {
      const Corner& g = corner.geometry();
      const auto e = static_cast<Eigen::Index>(x);
      speed = std::max({speed, std::abs(g.feed_in * g.direction_in[e]), std::abs(g.feed_out * g.direction_out[e])});
    }
    legs_.push_back({&axis, speed});
    if (smoothed) continue;
    tap_max_ = std::min(tap_max_, axis.acceleration_max * period / speed);
    step_max_ = std::min(step_max_, axis.jerk_max * period * period / speed);
  }
  constexpr int steps = 8, ratios = 2;
  for (const Mode& mode : granted.machine.modes) {
    if (mode.of_axis()) continue;
    const double band = mode.frequency_high - mode.frequency_low, spread = mode.damping_high - mode.damping_low;
    for (int i = 0; i <= (band > 0.0 ? steps : 0); ++i) {
      for (int j = 0; j <= (spread > 0.0 ? ratios : 0); ++j) {
        const double damping = mode.damping_low + spread * j / ratios;
        const double w = 2.0 * std::numbers::pi * period * (mode.frequency_low + band * i / steps);
        Line line{std::polar(std::exp(-damping * w), -w * std::sqrt((1.0 - damping) * (1.0 + damping))), 0.0, {1.0}};
        line.allowed = mode.residual_max / left_behind(response.smoothing(), line.turn);
        std::complex<double> sum = 0.0;
        for (int length = 1; length <= order_end; ++length) {
          sum = sum * line.turn + 1.0;
          line.left.push_back(std::abs(sum) / length);
        }
        lines_.push_back(std::move(line));
      }
    }
  }
}

namespace {

/// Lengths and weights of an outline.
struct Extent {
  int longest = 1, second = 1, order = 0;  ///< samples, of the averages
  double weight = 0.0;                     ///< of all impulses

  explicit Extent(const AveragesOutline& outline) {
    for (const int length : outline.lengths) {
      order += length - 1;
      second = std::max(second, std::min(longest, length));
      longest = std::max(longest, length);
    }
    for (const auto& [at, w] : outline.impulses) weight += w;
  }
  /// Samples until the third average has passed its largest tap.
  int third() const { return order - (longest - 1) - (second - 1); }
};

/// The weight of the impulses up to so many samples behind one of them, that one included.
double weight_within(const AveragesOutline& outline, std::size_t from, int samples) {
  double sum = 0.0;
  for (std::size_t i = from; i < outline.impulses.size(); ++i) {
    const auto apart = static_cast<int>(outline.impulses[i].first - outline.impulses[from].first);
    if (i == from || apart <= samples) sum += outline.impulses[i].second;
  }
  return sum;
}

}  // namespace

const char* RefutedOutlines::rule(const AveragesOutline& outline) const {
  const Extent all(outline);
  double largest = 0.0;
  for (const auto& [at, w] : outline.impulses) largest = std::max(largest, w);
  const bool plateau = all.longest > all.order - (all.longest - 1);
  if (largest / all.weight / (plateau ? all.longest : all.order + 1) > tap_max_ * surely) return "acceleration";
  const int unchanged = all.second - 1 - all.third();  // samples later, by the third average
  const double step = weight_within(outline, 0, unchanged) / all.weight / all.longest / all.second;
  if (step > step_max_ * surely) return "jerk";
  return rings(outline, all.weight) ? "vibration" : nullptr;
}

bool RefutedOutlines::legs_hold(const AveragesOutline& outline) const {
  const Extent all(outline);
  double most = 0.0;
  for (std::size_t i = 0; i < outline.impulses.size(); ++i)
    most = std::max(most, weight_within(outline, i, all.second - 1));
  const double tap = 1.0 / all.longest, step = most / all.weight / all.longest / all.second;
  return std::all_of(legs_.begin(), legs_.end(), [&](const FastestLeg& leg) {
    const double acceleration = leg.speed * tap / period_;
    return surely_holds(*leg.axis, leg.speed, acceleration, leg.speed * step / period_, period_);
  });
}

bool RefutedOutlines::rings(const AveragesOutline& outline, double weight) const {
  return std::any_of(lines_.begin(), lines_.end(), [&](const Line& line) {
    double left = 1.0;
    for (const int length : outline.lengths) left *= line.left[static_cast<std::size_t>(length)];
    if (left <= line.allowed) return false;  // impulses leave at most as much
    std::complex<double> sum = 0.0;
    std::size_t last = 0;
    for (const auto& [at, w] : outline.impulses) {
      sum = sum * std::pow(line.turn, static_cast<int>(at - last)) + w;
      last = at;
    }
    return left * std::abs(sum) / weight > line.allowed * surely;
  });
}

}  // namespace accdec
