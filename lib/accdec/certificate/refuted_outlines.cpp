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

/// The largest difference of neighbouring taps. The difference of two averages a >= b in series is 1/(a b) for b
/// samples. From a samples after its beginning on, it is as much below 0 for b samples. The third one averages this
/// over its length. The sum over all impulses is linear between the samples where one of these begins or ends.
double largest_step(const AveragesOutline& outline, const Extent& all) {
  const int third = all.third() + 1;
  const auto passed = [&](int k) {  // samples of the difference up to k, those below 0 taken away
    return std::clamp(k + 1, 0, all.second) - std::clamp(k + 1 - all.longest, 0, all.second);
  };
  double most = 0.0;
  const auto look = [&](int k) {
    double step = 0.0;
    for (const auto& [at, w] : outline.impulses) {
      const int since = k - static_cast<int>(at);
      step += w * (passed(since) - passed(since - third));
    }
    most = std::max(most, std::abs(step));
  };
  const bool constant = third == 1;  // from one of these samples to the next
  for (const auto& impulse : outline.impulses) {
    for (unsigned set = 0; set < (constant ? 4U : 8U); ++set) {
      const int k = static_cast<int>(impulse.first) + (set & 1U ? all.longest : 0) + (set & 2U ? all.second : 0) +
                    (set & 4U ? third : 0);
      look(k);
      if (!constant) look(k - 1);
    }
  }
  return most / (all.weight * third * all.longest * all.second);
}

}  // namespace

const char* RefutedOutlines::rule(const AveragesOutline& outline) const {
  const Extent all(outline);
  double largest = 0.0;
  for (const auto& [at, w] : outline.impulses) largest = std::max(largest, w);
  const bool plateau = all.longest > all.order - (all.longest - 1);
  if (largest / all.weight / (plateau ? all.longest : all.order + 1) > tap_max_ * surely) return "acceleration";
  const double most = 1.0 / (static_cast<double>(all.longest) * all.second);
  const double first = outline.impulses.front().second / all.weight * most;
  if (first > step_max_ * surely) return "jerk";
  if (most > step_max_ * surely && largest_step(outline, all) > step_max_ * surely) return "jerk";
  return rings(outline, all.weight) ? "vibration" : nullptr;
}

bool RefutedOutlines::legs_hold(const AveragesOutline& outline) const {
  const Extent all(outline);
  const auto hold = [&](double step) {
    return std::all_of(legs_.begin(), legs_.end(), [&](const FastestLeg& leg) {
      const double acceleration = leg.speed / all.longest / period_;
      return surely_holds(*leg.axis, leg.speed, acceleration, leg.speed * step / period_, period_);
    });
  };
  const double most = 1.0 / (static_cast<double>(all.longest) * all.second);
  return hold(most) || (hold(0.0) && hold(largest_step(outline, all)));
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
