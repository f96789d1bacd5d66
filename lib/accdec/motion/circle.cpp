#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <stdexcept>

#include <accdec/motion/circle.hpp>

namespace accdec {
namespace {

/// Plain convolution of commanded points: rest at angle 0, one turn in equal steps (the last one shorter), rest.
double simulate(const Filter& x, const Filter& y, double radius, double step) {
  const auto turn = static_cast<long>(std::min(1e15, std::ceil(2.0 * std::numbers::pi / step - 1e-9)));
  const auto angle = [&](long n) { return n <= 0 || n >= turn ? 0.0 : step * static_cast<double>(n); };
  const int order = std::max(x.order(), y.order());
  // While the filters see only the turn, samples half a turn apart have the same distance from the circle. With one
  // filter all have.
  const double half_turn = &x == &y ? 0.0 : std::ceil(std::numbers::pi / step);
  if (half_turn * order > circle_sums_max)
    throw std::invalid_argument(
        "the turn has too many samples for axes that differ; allowed is a smaller radius, a "
        "larger feed or a longer sample period");
  const long seen = 2L * order + 2 + static_cast<long>(half_turn);
  double worst = 0.0;
  for (long n = 0; n <= turn + order; ++n) {
    if (n == seen) n = std::max(n, turn - order - 2);
    double to_x = 0.0, to_y = 0.0;
    for (int i = 0; i <= order; ++i) {
      const double at = angle(n - i);
      to_x += x.tap(i) * std::cos(at), to_y += y.tap(i) * std::sin(at);
    }
    worst = std::max(worst, std::abs(radius * std::hypot(to_x, to_y) - radius));
  }
  return worst;
}

/// 1 - |H|^2 = sum_i sum_j b_i b_j (1 - cos((i - j) step)), without the cancellation of 1 - |H| for small steps.
double missing(const Filter& filter, double step) {
  double sum = 0.0;
  for (int i = 0; i <= filter.order(); ++i) {
    for (int j = 0; j < i; ++j) {
      const double s = std::sin(0.5 * step * (i - j));
      sum += 4.0 * filter.tap(i) * filter.tap(j) * s * s;
    }
  }
  return std::min(sum, 1.0);
}

/// |Hx^2 - Hy^2|/2
double apart(const Filter& x, const Filter& y, double step) {
  if (&x == &y) return 0.0;
  std::complex<double> difference = 0.0, sum = 0.0;
  for (int i = 0; i <= std::max(x.order(), y.order()); ++i) {
    const std::complex<double> turned = std::polar(1.0, -step * i);
    difference += (x.tap(i) - y.tap(i)) * turned, sum += (x.tap(i) + y.tap(i)) * turned;
  }
  return 0.5 * std::abs(difference * sum);
}

/// 1 - sqrt(1 - x)
double less_radius(double x) {
  return x / (1.0 + std::sqrt(std::max(0.0, 1.0 - x)));
}

}  // namespace

double tap_variance(const Filter& filter) {
  double variance = 0.0;
  for (int i = 0; i <= filter.order(); ++i) {
    const double from_mean = i - filter.mean_delay();
    variance += filter.tap(i) * from_mean * from_mean;
  }
  return variance;
}

CircleError circle_error(const Filter& x, const Filter& y, double radius, double feed, double sample_period) {
  const double step = feed * sample_period / radius;
  if (!(radius > 0.0 && feed > 0.0 && sample_period > 0.0) || !std::isfinite(radius) || !(step < std::numbers::pi)) {
    throw std::invalid_argument(
        "a circle needs a radius, a feed and a sample period > 0, and more than two samples a turn");
  }
  if (std::max(x.order(), y.order()) > circle_order_max)
    throw std::invalid_argument("the error of a circle is computed for filters of at most 20000 taps");
  const double less_x = missing(x, step), less = &x == &y ? less_x : 0.5 * (less_x + missing(y, step));
  const double more = apart(x, y, step), variance = 0.5 * (tap_variance(x) + tap_variance(y));
  CircleError error;
  error.deviation = std::sqrt(std::max(0.0, variance)) * sample_period;
  error.radius_error = radius * std::max(less_radius(less + more), -less_radius(less - more));
  error.small_angle = std::abs(feed * feed * variance * sample_period * sample_period / (2.0 * radius)) +
                      0.5 * feed * sample_period * std::abs(x.mean_delay() - y.mean_delay());
  error.simulated = simulate(x, y, radius, step);
  return error;
}

}  // namespace accdec
