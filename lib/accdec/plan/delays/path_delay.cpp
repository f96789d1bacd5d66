#include <algorithm>
#include <cmath>

#include <accdec/motion/least_held.hpp>
#include <accdec/plan/delays/path_delay.hpp>

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
    const int nearest =
        least_held(-1, filter_.order() + d + 1, [&](int k) { return !(distance2(k + 1, d) < distance2(k, d)); });
    return std::sqrt(std::min(segment2(nearest - 1, d), segment2(nearest, d)));
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
  // At the stop's delay the error is 0.
  return least_held(low, std::min(high, stop_delay), [&](int d) { return error(d) <= error_max; });
}

}  // namespace accdec
