#include <algorithm>
#include <array>
#include <cmath>

#include <accdec/motion/smallest_delay.hpp>
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

std::vector<int> pairwise_delays(const Toolpath& path, const Filter& filter, double sample_period) {
  const DelayFinder finder(filter);
  const std::size_t blocks = path.blocks(), n = path.dimensions();
  std::vector<int> delays(blocks, 0);
  // Half the mean absolute deviation of the taps: a smooth joint passed without delay errs by it times |v2 u2 - v1 u1| T at most.
  double spread = 0.0;
  for (int i = 0; i <= filter.order(); ++i) spread += filter.tap(i) * std::max(0.0, i - filter.mean_delay());

  std::array<double, program_axis_count> in{}, out{};
  double length_in = 0.0, length_out = 0.0;
  const auto load = [&](std::size_t b, std::array<double, program_axis_count>& delta) {
    const double* p = path.point(b);
    double sum = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      delta[i] = p[n + i] - p[i];
      sum += delta[i] * delta[i];
    }
    return std::sqrt(sum);
  };
  const auto pass = [&](Joint wanted, auto&& decide) {
    length_out = load(0, out);
    for (std::size_t b = 0; b + 1 < blocks; ++b) {
      in = out;
      length_in = length_out;
      length_out = load(b + 1, out);
      if (path.joint[b] == wanted) decide(b);
    }
  };
  const auto cos_interior = [&] {
    double dot = 0.0;
    for (std::size_t i = 0; i < n; ++i) dot += in[i] * out[i];
    return std::clamp(-dot / (length_in * length_out), -1.0, 1.0);
  };

  // Smooth joints first, for their delays decide where runs end and so by how much feeds are lowered. Unlowered feeds are the
  // worse case.
  pass(Joint::smooth, [&](std::size_t b) {
    const double step_in = length_in * sample_period / path.duration[b], step_out = length_out * sample_period / path.duration[b + 1];
    double change2 = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      const double change = out[i] / length_out * step_out - in[i] / length_in * step_in;
      change2 += change * change;
    }
    if (spread * spread * change2 <= path.tolerance[b] * path.tolerance[b]) return;
    delays[b] = smallest_path_delay(filter, cos_interior(), step_in, step_out, path.tolerance[b], finder.exact_stop_delay());
  });
  const CommandTiming timing(path, sample_period, delays);
  std::vector<double> lowered(blocks, 1.0);  // D/n of the run of a block
  for (std::size_t run = 0; run < blocks;) {
    const std::size_t end = timing.run_end(run);
    const double length = timing.run_length(run, end);
    const double factor = length / static_cast<double>(CommandTiming::run_samples(length));
    std::fill(lowered.begin() + static_cast<std::ptrdiff_t>(run), lowered.begin() + static_cast<std::ptrdiff_t>(end) + 1, factor);
    run = end + 1;
  }
  pass(Joint::corner, [&](std::size_t b) {
    const double step_in = length_in * sample_period / path.duration[b] * lowered[b];
    const double step_out = length_out * sample_period / path.duration[b + 1] * lowered[b + 1];
    delays[b] = finder(cos_interior(), step_in, step_out, path.tolerance[b]);
  });
  for (std::size_t b = 0; b + 1 < blocks; ++b) {
    if (path.joint[b] == Joint::stop) delays[b] = finder.exact_stop_delay();
  }
  return delays;
}

}  // namespace accdec
