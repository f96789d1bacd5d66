#include <algorithm>

#include <accdec/certificate/checked_tube.hpp>

namespace accdec {
namespace {

bool given(const Interval& limit) {
  return limit.hi < unlimited;
}

/// Upper bound on B_k after B_{k-1} <= x, itself known to be at most `high`.
double highest_after(const CheckedPlant& p, double x, double high) {
  const Interval slope = p.inertia + p.drag;
  if (!(slope.lo > 0.0)) return high;
  if (given(p.force)) {
    Interval most = p.force + p.inertia * Interval(x);
    if (p.stop) most = most + p.drag;
    high = std::min(high, (most / slope).hi);
  }
  if (!p.stop && given(p.power)) {
    // slope y^2 - inertia x y <= power
    const Interval b = p.inertia * Interval(x);
    high = std::min(high, ((b + square_root(b * b + 4.0 * slope * p.power)) / (2.0 * slope)).hi);
  }
  if (p.stop && given(p.regeneration)) {
    // With the remaining speed w = 1 - y: slope w^2 - inertia (1 - x) w + regeneration >= 0, so w is outside the roots.
    const Interval b = p.inertia * (Interval(1.0) - Interval(x)), square = b * b - 4.0 * slope * p.regeneration;
    if (square.lo > 0.0 && b.lo > 0.0) {
      const Interval root = square_root(square), small = (b - root) / (2.0 * slope), large = (b + root) / (2.0 * slope);
      if ((Interval(1.0) - Interval(high)).lo > small.hi) high = std::min(high, (Interval(1.0) - large).hi);
    }
  }
  return high;
}

/// Lower bound on B_{k-1} before B_k in [low, high].
double lowest_before(const CheckedPlant& p, double low, double high) {
  double x = 0.0;
  if (!(p.inertia.lo > 0.0)) return x;
  const Interval slope = p.inertia + p.drag, y(low);
  if (given(p.force)) {
    Interval most = slope * y - p.force;
    if (p.stop) most = most - p.drag;
    x = std::max(x, (most / p.inertia).lo);
  }
  if (!p.stop && given(p.power) && low > 0.0) x = std::max(x, ((slope * y - p.power / y) / p.inertia).lo);
  if (p.stop && given(p.regeneration) && high < 1.0) {
    // 1 - B_{k-1} <= (slope w + regeneration/w)/inertia, convex in w: largest at an end.
    double most = 0.0;
    for (const double end : {low, high}) {
      const Interval w = Interval(1.0) - Interval(end);
      if (!(w.lo > 0.0)) return x;
      most = std::max(most, ((slope * w + p.regeneration / w) / p.inertia).hi);
    }
    x = std::max(x, (Interval(1.0) - Interval(most)).lo);
  }
  return x;
}

}  // namespace

std::optional<CheckedTube> checked_tube(const std::vector<CheckedPlant>& plants, double tap_max, double jerk_max,
                                        int order, const std::vector<CheckedCut>& cuts) {
  const auto last = static_cast<std::size_t>(order) + 1;
  CheckedTube tube;
  tube.low.assign(last + 1, 0.0);
  tube.high.assign(last + 1, 1.0);
  tube.high.front() = 0.0;
  tube.low.back() = 1.0;
  for (const CheckedCut& cut : cuts) {
    const auto k = static_cast<std::size_t>(std::clamp(cut.sample, 0, order + 1));
    if (cut.upper)
      tube.high[k] = std::min(tube.high[k], cut.level);
    else
      tube.low[k] = std::max(tube.low[k], cut.level);
  }
  // Tap i is at most (i + 1) jerk_max, and as much from the other end.
  Interval sum(0.0);
  for (std::size_t k = 1; k < last && sum.hi < 1.0; ++k) {
    sum = sum + Interval(std::min(tap_max, (Interval(jerk_max) * static_cast<double>(k)).hi));
    tube.high[k] = std::min(tube.high[k], sum.hi);
    tube.low[last - k] = std::max(tube.low[last - k], (Interval(1.0) - sum).lo);
  }
  for (int sweep = 0; sweep < 40; ++sweep) {
    double change = 0.0;
    for (std::size_t k = 1; k <= last; ++k) {
      double high = std::min(tube.high[k], (Interval(tube.high[k - 1]) + Interval(tap_max)).hi);
      for (const CheckedPlant& p : plants) high = highest_after(p, tube.high[k - 1], high);
      change = std::max({change, tube.high[k] - high, tube.low[k - 1] - tube.low[k]});
      tube.high[k] = high;
      tube.low[k] = std::max(tube.low[k], tube.low[k - 1]);
      if (tube.low[k] > tube.high[k]) return std::nullopt;
    }
    for (std::size_t k = last; k > 0; --k) {
      double low = std::max(tube.low[k - 1], (Interval(tube.low[k]) - Interval(tap_max)).lo);
      for (const CheckedPlant& p : plants) low = std::max(low, lowest_before(p, tube.low[k], tube.high[k]));
      change = std::max({change, low - tube.low[k - 1], tube.high[k - 1] - tube.high[k]});
      tube.low[k - 1] = low;
      tube.high[k - 1] = std::min(tube.high[k - 1], tube.high[k]);
      if (tube.low[k - 1] > tube.high[k - 1]) return std::nullopt;
    }
    if (change < 1e-7) break;
  }
  return tube;
}

}  // namespace accdec
