#include <algorithm>
#include <array>
#include <cmath>

#include <accdec/motion/smallest_delay.hpp>
#include <accdec/program/corner_limits.hpp>
#include <accdec/program/plan.hpp>

namespace accdec {
namespace {

/// Distance of the joint from the path through the samples of a lone blend with delay d, in the plane of the legs.
class PathError {
 public:
  PathError(const Filter& filter, double cos_interior, double step_in, double step_out)
      : filter_(filter),
        step_in_(step_in),
        step_out_(step_out),
        cos_turn_(-cos_interior),
        sin_turn_(std::sqrt(std::max(0.0, (1.0 - cos_interior) * (1.0 + cos_interior)))) {}

  double operator()(int d) const {
    // Along the window the distance falls, then rises: bisection on its slope finds the nearest sample.
    int low = 0, high = filter_.order() + d + 1;
    while (low < high) {
      const int middle = low + (high - low) / 2;
      if (distance2(middle + 1, d) < distance2(middle, d)) {
        low = middle + 1;
      } else {
        high = middle;
      }
    }
    const double x = std::sqrt(std::min(segment2(low - 1, d), segment2(low, d)));
    return x;
  }

 private:
  struct Point {
    double x, y;
  };
  Point at(int k, int d) const {
    const double p = filter_.remaining_moment(k) * step_in_, q = filter_.elapsed_moment(k - d) * step_out_;
    return {q * cos_turn_ - p, q * sin_turn_};
  }
  double distance2(int k, int d) const {
    const Point s = at(k, d);
    return s.x * s.x + s.y * s.y;
  }
  double segment2(int k, int d) const {
    const Point a = at(k, d), b = at(k + 1, d);
    const double dx = b.x - a.x, dy = b.y - a.y, length2 = dx * dx + dy * dy;
    const double t = length2 > 0.0 ? std::clamp(-(a.x * dx + a.y * dy) / length2, 0.0, 1.0) : 0.0;
    const double x = a.x + t * dx, y = a.y + t * dy;
    return x * x + y * y;
  }

  const Filter& filter_;
  double step_in_, step_out_, cos_turn_, sin_turn_;
};

}  // namespace

int smallest_path_delay(const Filter& filter, double cos_interior, double step_in, double step_out, double error_max,
                        int stop_delay) {
  const PathError error(filter, cos_interior, step_in, step_out);
  int low = 0, high = 1;
  if (error(0) <= error_max) return 0;
  while (high < stop_delay && error(high) > error_max) low = high, high *= 2;
  high = std::min(high, stop_delay);  // where the error is 0
  while (high - low > 1) {
    const int middle = low + (high - low) / 2;
    (error(middle) <= error_max ? high : low) = middle;
  }
  return high;
}

PairwiseDelays pairwise_delays(const Toolpath& path, const Filter& filter, double sample_period, const Machine& machine,
                               DelayRule rule) {
  const DelayFinder finder(filter);
  const CornerLimits limits(filter, machine, sample_period);
  const bool limited = !machine.axes.empty();
  const std::size_t blocks = path.blocks(), n = path.dimensions();
  PairwiseDelays result;
  std::vector<int>& delays = result.delays;
  delays.assign(blocks, 0);
  // Half the mean absolute deviation of the taps: a smooth joint passed without delay errs by it times |v2 u2 - v1 u1| T at most.
  double spread = 0.0;
  for (int i = 0; i <= filter.order(); ++i) spread += filter.tap(i) * std::max(0.0, i - filter.mean_delay());

  // Velocities of the legs of a joint, m/s.
  std::array<double, program_axis_count> in{}, out{};
  double speed_in = 0.0, speed_out = 0.0;
  const auto load = [&](std::size_t b, double factor) {
    const double* p = path.point(b);
    double sum = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      out[i] = (p[n + i] - p[i]) / path.duration[b] * factor;
      sum += out[i] * out[i];
    }
    speed_out = std::sqrt(sum);
  };
  const auto cos_interior = [&] {
    double dot = 0.0;
    for (std::size_t i = 0; i < n; ++i) dot += in[i] * out[i];
    return std::clamp(-dot / (speed_in * speed_out), -1.0, 1.0);
  };
  const auto within_limits = [&](int delay) {
    return limited ? limits.smallest(in.data(), out.data(), delay, result.limits_possible) : delay;
  };
  const auto is_stop = [&](std::size_t b) {
    return path.joint[b] == Joint::stop || (rule == DelayRule::exact_stop && path.inside_arc[b] == 0);
  };
  const auto smooth_delay = [&](std::size_t b) {
    if (rule != DelayRule::smallest) return 0;
    double change2 = 0.0;
    for (std::size_t i = 0; i < n; ++i) change2 += (out[i] - in[i]) * (out[i] - in[i]);
    const double bound = path.tolerance[b];
    int delay = 0;
    if (spread * spread * change2 * sample_period * sample_period > bound * bound) {
      delay = smallest_path_delay(filter, cos_interior(), speed_in * sample_period, speed_out * sample_period, bound,
                                  finder.exact_stop_delay());
    }
    return within_limits(delay);
  };

  // All but corners first, for delays of smooth joints decide where runs end and so by how much feeds are lowered. Unlowered feeds
  // are the worse case.
  load(0, 1.0);
  for (std::size_t b = 0; b + 1 < blocks; ++b) {
    in = out;
    speed_in = speed_out;
    load(b + 1, 1.0);
    if (is_stop(b)) {
      delays[b] = within_limits(finder.exact_stop_delay());
    } else if (path.joint[b] != Joint::corner) {
      delays[b] = smooth_delay(b);
    }
  }
  if (rule != DelayRule::smallest) return result;

  const CommandTiming timing(path, sample_period, delays);
  std::size_t run_first = 0, run_last = 0;
  double factor = 1.0;  // D/n of the run of a block
  const auto lowered = [&](std::size_t b) {
    if (b == 0 || b > run_last) {
      run_first = b;
      run_last = timing.run_end(b);
      const double length = timing.run_length(run_first, run_last);
      factor = length / static_cast<double>(CommandTiming::run_samples(length));
    }
    return factor;
  };
  load(0, lowered(0));
  for (std::size_t b = 0; b + 1 < blocks; ++b) {
    in = out;
    speed_in = speed_out;
    load(b + 1, lowered(b + 1));
    if (path.joint[b] != Joint::corner) continue;
    const int delay = finder(cos_interior(), speed_in * sample_period, speed_out * sample_period, path.tolerance[b]);
    delays[b] = within_limits(delay);
  }
  return result;
}

}  // namespace accdec
