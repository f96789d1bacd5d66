#include <algorithm>
#include <cmath>

#include <accdec/plan/delays/joint_delays.hpp>
#include <accdec/plan/delays/pairwise_delays.hpp>

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
  JointDelays joints(path, filter, sample_period, machine);
  const std::size_t blocks = path.blocks();
  PairwiseDelays result;
  const auto judge = [&](std::size_t b) {
    if (!joints.take_possible()) result.impossible.push_back(b);
  };
  std::vector<int>& delays = result.delays;
  delays.assign(blocks, 0);
  // All joints except corners come first: delays of smooth joints decide where runs end, and so how much feeds are
  // lowered. Unlowered feeds are the worse case.
  for (std::size_t b = 0; b + 1 < blocks; ++b) {
    if (path.joint[b] == Joint::stop || (rule == DelayRule::exact_stop && path.inside_arc[b] == 0)) {
      delays[b] = joints.stop(b);
    } else if (path.joint[b] != Joint::corner && rule == DelayRule::smallest) {
      delays[b] = joints.smooth(b);
    }
    judge(b);
  }
  if (rule == DelayRule::smallest) {
    const CommandTiming timing(path, sample_period, delays);
    std::size_t run_last = 0;
    double factor = 1.0;  // D/n of the run of a block
    const auto lowered = [&](std::size_t b) {
      if (b == 0 || b > run_last) {
        run_last = timing.run_end(b);
        const double length = timing.run_length(b, run_last);
        factor = length / static_cast<double>(CommandTiming::run_samples(length));
      }
      return factor;
    };
    double factor_in = 1.0, factor_out = lowered(0);
    for (std::size_t b = 0; b + 1 < blocks; ++b) {
      factor_in = factor_out;
      factor_out = lowered(b + 1);
      if (path.joint[b] != Joint::corner) continue;
      delays[b] = joints.corner(b, factor_in, factor_out);
      judge(b);
    }
  }
  std::sort(result.impossible.begin(), result.impossible.end());
  result.limits_possible = result.impossible.empty();
  return result;
}

std::size_t raised_delays(const Toolpath& path, const Filter& filter, double sample_period, const Machine& machine,
                          const std::vector<int>& delays, const std::vector<int>& alone) {
  std::vector<int> found;
  if (alone.empty()) found = pairwise_delays(path, filter, sample_period, machine).delays;
  const std::vector<int>& least = alone.empty() ? found : alone;
  std::size_t raised = 0;
  for (std::size_t b = 0; b < least.size(); ++b) raised += delays[b] > least[b] ? 1 : 0;
  return raised;
}

}  // namespace accdec
