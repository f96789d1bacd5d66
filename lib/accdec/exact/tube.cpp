#include <algorithm>
#include <cmath>

#include <accdec/exact/tube.hpp>

namespace accdec::exact {

double TubeLimits::Plant::most_after(double x, double high) const {
  const double slope = inertia + drag;
  double y = high;
  if (!(slope > 0.0)) return y;
  if (!stop) {
    if (force < unlimited) y = std::min(y, (force + inertia * x) / slope);
    if (power < unlimited)
      y = std::min(y, (inertia * x + std::sqrt(inertia * inertia * x * x + 4.0 * slope * power)) / (2.0 * slope));
    return y;
  }
  if (force < unlimited) y = std::min(y, (force + drag + inertia * x) / slope);
  // The remaining speed w is at most the smaller root of slope w^2 - inertia (1 - x) w + regeneration = 0, or at least
  // the larger root.
  const double b = inertia * (1.0 - x), square = b * b - 4.0 * slope * regeneration;
  if (regeneration < unlimited && square > 0.0) {
    const double small = (b - std::sqrt(square)) / (2.0 * slope), large = (b + std::sqrt(square)) / (2.0 * slope);
    if (1.0 - y > small + 1e-9) y = std::min(y, 1.0 - large);
  }
  return y;
}

double TubeLimits::Plant::least_before(double low, double high) const {
  double x = 0.0;
  if (!(inertia > 0.0)) return x;
  const double slope = inertia + drag;
  if (!stop) {
    if (force < unlimited) x = std::max(x, (slope * low - force) / inertia);
    if (power < unlimited && low > 0.0) x = std::max(x, (slope * low - power / low) / inertia);
    return x;
  }
  if (force < unlimited) x = std::max(x, (slope * low - force - drag) / inertia);
  if (regeneration < unlimited && high < 1.0) {
    const auto before = [&](double w) { return (slope * w + regeneration / w) / inertia; };
    x = std::max(x, 1.0 - std::max(before(1.0 - low), before(1.0 - high)));
  }
  return x;
}

TubeLimits::TubeLimits(const Task& task, const ConvexRows& rows)
    : longer_(rows.motion().order()), tap_max_(rows.command_tap_max()), jerk_max_(rows.ramp_max(LimitKind::jerk)) {
  const std::vector<EventSpeeds> speeds = event_speeds(task);
  for (std::size_t a = 0; a < speeds.size(); ++a) {
    const Axis& axis = task.machine.axes[a];
    for (const bool stop : {false, true}) {
      const double s = stop ? speeds[a].stop : speeds[a].start;
      if (s == 0.0) continue;
      const double force = axis.force_max + (stop ? axis.coulomb : -axis.coulomb);
      plants_.push_back({axis.mass / task.sample_period, axis.damping, force / s, axis.power_max / (s * s),
                         axis.regeneration_max / (s * s), stop});
    }
  }
}

/// Starts with the range that splits and jerk leave.
void TubeLimits::begin(Box& box) const {
  Tube& tube = box.tube;
  const int n = box.order + longer_;
  tube.low.assign(static_cast<std::size_t>(n) + 2, 0.0);
  tube.high.assign(static_cast<std::size_t>(n) + 2, 1.0);
  tube.high.front() = 0.0;
  tube.low.back() = 1.0;
  for (const SumBound& b : box.path) {
    const auto k = static_cast<std::size_t>(std::clamp(b.sample, 0, n + 1));
    double& end = b.upper ? tube.high[k] : tube.low[k];
    end = b.upper ? std::min(end, b.level) : std::max(end, b.level);
  }
  // Jerk bounds the taps' growth from either end.
  double tap = 0.0, sum = 0.0;
  for (std::size_t k = 1; k + 1 < tube.low.size() && sum < 1.0; ++k) {
    tap = std::min(tap_max_, tap + jerk_max_);
    sum += tap;
    tube.high[k] = std::min(tube.high[k], sum * (1.0 + 1e-12));
    double& low = tube.low[tube.low.size() - 1 - k];
    low = std::max(low, 1.0 - sum * (1.0 + 1e-12));
  }
}

bool TubeLimits::shrink(Box& box) const {
  begin(box);
  Tube& tube = box.tube;
  double change = 1.0;
  for (int sweep = 0; sweep < 12 && change > 1e-6; ++sweep) {
    change = 0.0;
    const auto cut = [&](std::size_t k, double low, double high) {
      change = std::max({change, low - tube.low[k], tube.high[k] - high});
      tube.low[k] = std::max(tube.low[k], low);
      tube.high[k] = std::min(tube.high[k], high);
      return tube.low[k] <= tube.high[k] + 1e-9;
    };
    for (std::size_t k = 1; k < tube.low.size(); ++k) {
      double high = std::min(tube.high[k], tube.high[k - 1] + tap_max_);
      for (const Plant& p : plants_) high = p.most_after(tube.high[k - 1], high);
      if (!cut(k, tube.low[k - 1], high)) return false;
    }
    for (std::size_t k = tube.low.size() - 1; k > 0; --k) {
      double low = tube.low[k] - tap_max_;
      for (const Plant& p : plants_) low = std::max(low, p.least_before(tube.low[k], tube.high[k]));
      if (!cut(k - 1, low, tube.high[k])) return false;
    }
  }
  for (std::size_t k = 0; k < tube.low.size(); ++k) {
    if (tube.low[k] > tube.high[k]) std::swap(tube.low[k], tube.high[k]);
  }
  return true;
}

}  // namespace accdec::exact
