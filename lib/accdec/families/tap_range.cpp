#include <algorithm>
#include <cmath>
#include <complex>

#include <accdec/families/tap_range.hpp>
#include <accdec/machine/limits.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

/// A limit is certainly broken only beyond the verification's tolerance.
constexpr double range_slack = 1.0 + granted_tolerance;

struct Between {
  double low, high;
};
Between operator+(Between a, Between b) {
  return {a.low + b.low, a.high + b.high};
}
Between operator-(Between a, Between b) {
  return {a.low - b.high, a.high - b.low};
}
Between operator*(double s, Between a) {
  return s >= 0.0 ? Between{s * a.low, s * a.high} : Between{s * a.high, s * a.low};
}
Between operator*(Between a, Between b) {
  const auto [low, high] = std::minmax({a.low * b.low, a.low * b.high, a.high * b.low, a.high * b.high});
  return {low, high};
}
/// Smallest magnitude.
double magnitude(Between a) {
  return std::max({a.low, -a.high, 0.0});
}

Between tap(const TapRange& range, int i) {
  if (i < 0 || i > range.order()) return {0.0, 0.0};
  return {range.low[static_cast<std::size_t>(i)], range.high[static_cast<std::size_t>(i)]};
}
Between cumulative(const TapRange& range, int k) {
  if (k <= 0) return {0.0, 0.0};
  if (k > range.order()) return {1.0, 1.0};
  return {range.cumulative_low[static_cast<std::size_t>(k)], range.cumulative_high[static_cast<std::size_t>(k)]};
}
Between stop(const TapRange& range, int k) {
  if (k > range.order()) return {0.0, 0.0};
  const auto at = static_cast<std::size_t>(std::max(k, 0));
  return {range.stop_low[at] + (k < 0 ? -k : 0), range.stop_high[at] + (k < 0 ? -k : 0)};
}
Between start(const TapRange& range, int m) {
  if (m <= 0) return {0.0, 0.0};
  const auto at = static_cast<std::size_t>(std::min(m, range.order()));
  const double beyond = std::max(0, m - range.order());
  return {range.start_low[at] + beyond, range.start_high[at] + beyond};
}

bool axis_breaks(const Axis& axis, Between v, Between a, Between before, double period) {
  if (magnitude(v) > axis.velocity_max * range_slack || magnitude(a) > axis.acceleration_max * range_slack) return true;
  if (axis.jerk_max < unlimited && magnitude(a - before) / period > axis.jerk_max * range_slack) return true;
  if (axis.force_max == unlimited && axis.power_max == unlimited && axis.regeneration_max == unlimited) return false;
  const Between moving = axis.mass * a + axis.damping * v;
  const Between force{moving.low - axis.coulomb, moving.high + axis.coulomb};
  if (magnitude(force) > axis.force_max * range_slack) return true;
  if (axis.power_max == unlimited && axis.regeneration_max == unlimited) return false;
  const Between power = force * v;
  return power.low > axis.power_max * range_slack || -power.high > axis.regeneration_max * range_slack;
}

/// Whether every filter breaks a limit of one axis on a start to `speed`, or a stop from it.
bool ramp_breaks(const TapRange& range, const Axis& axis, double speed, bool stops, double period) {
  if (speed == 0.0) return false;
  Between before{0.0, 0.0};
  for (int k = 0; k <= range.order() + settling; ++k) {
    const Between gone = cumulative(range, k);
    const Between v = speed * (stops ? Between{1.0, 1.0} - gone : gone);
    const Between a = ((stops ? -speed : speed) / period) * tap(range, k - 1);
    if (axis_breaks(axis, v, a, before, period)) return true;
    before = a;
  }
  return false;
}

bool rings(const TapRange& range, const std::vector<Tone>& tones) {
  for (const Tone& tone : tones) {
    std::complex<double> sum = 0.0, phase = 1.0;
    double radius = 0.0;
    const std::complex<double> turn = std::polar(1.0, -tone.phase);
    for (std::size_t i = 0; i < range.low.size(); ++i) {
      sum += 0.5 * (range.low[i] + range.high[i]) * phase;
      radius += 0.5 * (range.high[i] - range.low[i]);
      phase *= turn;
    }
    if (std::abs(sum) - radius > tone.residual_max * range_slack + 1e-12) return true;
  }
  return false;
}

/// Whether every filter passes a corner with more than its error bound, with this delay or any smaller one. Up to 90
/// degrees, |S| grows with both legs' distances. Beyond, the nearest point of all distances at least as large counts.
bool misses(const TapRange& range, const TaskCorner& corner, int delay, double period) {
  if (!corner.error_max) return false;
  const Corner& g = corner.geometry();
  const double cosine = g.cos_interior(), sine = std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
  const double allowed = granted_error(*corner.error_max);
  for (int k = 0; k <= range.order() + delay + 1; ++k) {
    const double p = g.feed_in * period * stop(range, k).low, q = g.feed_out * period * start(range, k - delay).low;
    double nearest = 0.0;
    if (cosine < 0.0 && q < -p * cosine)
      nearest = p * sine;
    else if (cosine < 0.0 && p < -q * cosine)
      nearest = q * sine;
    else
      nearest = std::sqrt(std::max(0.0, p * p + q * q + 2.0 * p * q * cosine));
    if (nearest <= allowed) return false;
  }
  return true;
}

/// Smallest |S| of all distances in a box; it lies on an edge, at the edge's nearest point.
double nearest_in(Between p, Between q, double cosine) {
  double least = unlimited;
  const auto edge = [&](double fixed, Between other) {
    const double x = std::clamp(-fixed * cosine, other.low, other.high);
    least = std::min(least, fixed * fixed + x * x + 2.0 * fixed * x * cosine);
  };
  for (const double fixed : {p.low, p.high}) edge(fixed, q);
  for (const double fixed : {q.low, q.high}) edge(fixed, p);
  return std::sqrt(std::max(0.0, least));
}

/// Whether every filter passes a corner with more than its error bound, with exactly this delay.
bool error_breaks(const TapRange& range, const TaskCorner& corner, int delay, double period) {
  const Corner& g = corner.geometry();
  const double cosine = g.cos_interior();
  if (!corner.error_max || cosine >= 0.0) return false;  // `misses` covers this case
  const double allowed = granted_error(*corner.error_max);
  for (int k = 0; k <= range.order() + delay + 1; ++k) {
    const Between p = (g.feed_in * period) * stop(range, k), q = (g.feed_out * period) * start(range, k - delay);
    if (nearest_in(p, q, cosine) <= allowed) return false;
  }
  return true;
}

bool blend_breaks(const TapRange& range, const TaskCorner& corner, int delay, const Task& task) {
  const double period = task.sample_period;
  const Corner& g = corner.geometry();
  const int last = range.order() + delay + settling;
  std::vector<double> speed_squared(corner.speed_min > 0.0 ? static_cast<std::size_t>(last) + 1 : 0, 0.0);
  for (std::size_t x = 0; x < task.machine.axes.size(); ++x) {
    const auto e = static_cast<Eigen::Index>(x);
    const double in = g.feed_in * g.direction_in[e], out = g.feed_out * g.direction_out[e];
    Between before{0.0, 0.0};
    for (int k = 0; k <= last; ++k) {
      const Between v = in * (Between{1.0, 1.0} - cumulative(range, k)) + out * cumulative(range, k - delay);
      const Between a = (1.0 / period) * (out * tap(range, k - 1 - delay) - in * tap(range, k - 1));
      if (axis_breaks(task.machine.axes[x], v, a, before, period)) return true;
      before = a;
      if (corner.speed_min > 0.0)
        speed_squared[static_cast<std::size_t>(k)] += std::max(v.low * v.low, v.high * v.high);
    }
  }
  return std::any_of(speed_squared.begin(), speed_squared.end(),
                     [&](double s) { return corner.speed_min > std::sqrt(s) * range_slack; });
}

}  // namespace

TapRange tap_range(std::span<const double> one, std::span<const double> other, int pairs, int pair_delay) {
  const std::size_t n = one.size();
  TapRange range;
  std::vector<double> low(n), high(n);
  double low_sum = 0.0, high_sum = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    low[i] = std::min(one[i], other[i]);
    high[i] = std::max(one[i], other[i]);
    low_sum += low[i];
    high_sum += high[i];
  }
  // A part of the sum is smallest relative to the rest when it is at its low and the rest at its high end.
  const auto part = [](double part, double rest) { return part > 0.0 ? part / (part + rest) : 0.0; };
  double gone_low = 0.0, gone_high = 0.0;
  range.cumulative_low.push_back(0.0);
  range.cumulative_high.push_back(0.0);
  for (std::size_t i = 0; i < n; ++i) {
    range.low.push_back(part(low[i], high_sum - high[i]));
    range.high.push_back(std::min(1.0, part(high[i], std::max(0.0, low_sum - low[i]))));
    gone_low += low[i];
    gone_high += high[i];
    range.cumulative_low.push_back(part(gone_low, std::max(0.0, high_sum - gone_high)));
    range.cumulative_high.push_back(std::min(1.0, part(gone_high, std::max(0.0, low_sum - gone_low))));
  }
  const auto follow = [&](std::vector<double>& values, double end) {
    const std::size_t by = static_cast<std::size_t>(pair_delay), m = values.size();
    std::vector<double> next(m + by, 0.0);
    for (std::size_t i = 0; i < next.size(); ++i) {
      next[i] = 0.5 * ((i < m ? values[i] : end) + (i >= by ? values[i - by] : 0.0));
    }
    values = std::move(next);
  };
  for (int p = 0; p < pairs; ++p) {
    follow(range.low, 0.0);
    follow(range.high, 0.0);
    follow(range.cumulative_low, 1.0);
    follow(range.cumulative_high, 1.0);
  }
  const std::size_t size = range.low.size();
  const auto distances = [&](const std::vector<double>& cumulative, std::vector<double>& stop,
                             std::vector<double>& start) {
    stop.assign(size, 0.0);
    for (std::size_t k = size - 1; k-- > 0;) stop[k] = stop[k + 1] + (1.0 - cumulative[k + 1]);
    start.assign(size, 0.0);
    for (std::size_t m = 1; m < size; ++m) start[m] = start[m - 1] + cumulative[m];
  };
  distances(range.cumulative_high, range.stop_low, range.start_high);
  distances(range.cumulative_low, range.stop_high, range.start_low);
  return range;
}

double lower_cost(const TapRange& range, const Task& task, const LinearCost& cost, const std::vector<Tone>& tones,
                  const std::vector<int>& least, double best) {
  double bound = cost(range.order(), least);
  if (bound >= best) return bound;
  const double period = task.sample_period;
  for (const TaskCorner& corner : task.corners) {
    for (std::size_t x = 0; x < task.machine.axes.size(); ++x) {
      const auto e = static_cast<Eigen::Index>(x);
      const Corner& g = corner.geometry();
      if (ramp_breaks(range, task.machine.axes[x], std::abs(g.feed_in * g.direction_in[e]), false, period))
        return unlimited;
      if (ramp_breaks(range, task.machine.axes[x], std::abs(g.feed_out * g.direction_out[e]), true, period))
        return unlimited;
    }
  }
  if (rings(range, tones)) return unlimited;
  std::vector<int> delays = least;
  for (std::size_t j = 0; j < delays.size(); ++j) {
    const TaskCorner& corner = task.corners[j];
    // From N + 2 on nothing changes.
    const int last = corner.delay.value_or(std::max(delays[j], range.order() + settling));
    int good = last, bad = delays[j] - 1;
    if (misses(range, corner, last, period)) return unlimited;
    while (good - bad > 1) (misses(range, corner, (good + bad) / 2, period) ? bad : good) = (good + bad) / 2;
    bound += cost.delay[j] * (good - delays[j]);
    delays[j] = good;
    if (bound >= best) return bound;
  }
  for (std::size_t j = 0; j < delays.size(); ++j) {
    const TaskCorner& corner = task.corners[j];
    const int last = corner.delay.value_or(std::max(delays[j], range.order() + settling));
    while (error_breaks(range, corner, delays[j], period) || blend_breaks(range, corner, delays[j], task)) {
      if (++delays[j] > last) return unlimited;
      bound += cost.delay[j];
      if (bound >= best) return bound;
    }
  }
  return bound;
}

}  // namespace accdec
