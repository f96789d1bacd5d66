#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <stdexcept>

#include <accdec/motion/circle.hpp>

namespace accdec {
namespace {

/// Plain convolution of commanded points: rest at angle 0, one turn in equal steps (the last one shorter), rest.
double simulate(const Filter& filter, double radius, double step) {
  using Complex = std::complex<double>;
  const auto turn = static_cast<long>(std::min(1e15, std::ceil(2.0 * std::numbers::pi / step - 1e-9)));
  const auto command = [&](long n) {
    if (n <= 0 || n >= turn) return Complex(radius, 0.0);
    return std::polar(radius, step * static_cast<double>(n));
  };
  double worst = 0.0;
  for (long n = 0; n <= turn + filter.order(); ++n) {
    // While the filter sees only the turn, all samples have the same distance from the circle.
    if (n == 2L * filter.order() + 2) n = std::max(n, turn - filter.order() - 2);
    Complex point = 0.0;
    for (int i = 0; i <= filter.order(); ++i) point += filter.tap(i) * command(n - i);
    worst = std::max(worst, std::abs(std::abs(point) - radius));
  }
  return worst;
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

CircleError circle_error(const Filter& filter, double radius, double feed, double sample_period) {
  const double step = feed * sample_period / radius;
  if (!(radius > 0.0 && feed > 0.0 && sample_period > 0.0) || !std::isfinite(radius) || !(step < std::numbers::pi)) {
    throw std::invalid_argument(
        "a circle needs a radius, a feed and a sample period > 0, and more than two samples a turn");
  }
  if (filter.order() > circle_order_max)
    throw std::invalid_argument("the error of a circle is computed for filters of at most 20000 taps");
  // 1 - |H|^2 = sum_i sum_j b_i b_j (1 - cos((i - j) step)), without the cancellation of 1 - |H| for small steps.
  double missing = 0.0;
  for (int i = 0; i <= filter.order(); ++i) {
    for (int j = 0; j < i; ++j) {
      const double s = std::sin(0.5 * step * (i - j));
      missing += 4.0 * filter.tap(i) * filter.tap(j) * s * s;
    }
  }
  missing = std::min(missing, 1.0);
  CircleError error;
  error.deviation = std::sqrt(tap_variance(filter)) * sample_period;
  error.radius_error = radius * missing / (1.0 + std::sqrt(1.0 - missing));
  error.small_angle = feed * feed * error.deviation * error.deviation / (2.0 * radius);
  error.simulated = simulate(filter, radius, step);
  return error;
}

}  // namespace accdec
