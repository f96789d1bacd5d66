#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

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
    : tap_max_(std::numeric_limits<double>::infinity()), step_max_(tap_max_) {
  const double period = granted.sample_period;
  // Behind a smoothing taps and their differences are smaller.
  const bool smoothed = response.smoothing().size() > 1;
  for (const TaskCorner& corner : granted.corners) {
    const Corner& g = corner.geometry();
    for (std::size_t x = 0; x < granted.machine.axes.size() && !smoothed; ++x) {
      const auto e = static_cast<Eigen::Index>(x);
      const double speed = std::max(std::abs(g.feed_in * g.direction_in[e]), std::abs(g.feed_out * g.direction_out[e]));
      tap_max_ = std::min(tap_max_, granted.machine.axes[x].acceleration_max * period / speed);
      step_max_ = std::min(step_max_, granted.machine.axes[x].jerk_max * period * period / speed);
    }
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

const char* RefutedOutlines::rule(const AveragesOutline& outline) const {
  int longest = 1, second = 1, order = 0;
  double all = 1.0;
  for (const int length : outline.lengths) {
    order += length - 1, all *= length;
    second = std::max(second, std::min(longest, length));
    longest = std::max(longest, length);
  }
  double weight = 0.0, largest = 0.0;
  for (const auto& [at, w] : outline.impulses) weight += w, largest = std::max(largest, w);
  const bool plateau = longest > order - (longest - 1);
  if (largest / weight / (plateau ? longest : order + 1) > tap_max_ * surely) return "acceleration";
  const int third = order - (longest - 1) - (second - 1);  // samples until the others have passed their largest tap
  const bool alone = outline.impulses.size() < 2 || static_cast<int>(outline.impulses[1].first) > third;
  const double two = static_cast<double>(longest) * second;
  if (outline.impulses.front().second / weight / (alone ? two : all) > step_max_ * surely) return "jerk";
  return rings(outline, weight) ? "vibration" : nullptr;
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
