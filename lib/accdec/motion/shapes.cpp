#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include <accdec/filter.hpp>
#include <accdec/motion/windows.hpp>

namespace accdec {
namespace {

using std::numbers::pi;

void require_order(const char* shape, int order, int least) {
  if (order < least) throw std::invalid_argument(fmt::format("{} needs order >= {}, got {}", shape, least, order));
}

/// Fills the first half from `shape(i)` and mirrors it, so that symmetric shapes are symmetric to the last bit.
template <class Shape>
Filter symmetric_filter(int order, Shape shape) {
  std::vector<double> taps(static_cast<std::size_t>(order) + 1);
  for (int i = 0; i <= order / 2; ++i) {
    // Cosine windows miss their exact zeros by an ulp to either side: a tap of -1e-17 is a zero.
    const double b = shape(i);
    taps[static_cast<std::size_t>(i)] = taps[static_cast<std::size_t>(order - i)] = std::abs(b) < 1e-15 ? 0.0 : b;
  }
  return Filter(std::move(taps));
}

}  // namespace

double blackman_window(int i, int order) {
  const double x = 2.0 * pi * i / order;
  return 0.42 - 0.5 * std::cos(x) + 0.08 * std::cos(2.0 * x);
}

Filter boxcar(int order) {
  require_order("boxcar", order, 0);
  return Filter(std::vector<double>(static_cast<std::size_t>(order) + 1, 1.0));
}

Filter trapezoid(int order, int ramp) {
  require_order("trapezoid", order, 0);
  if (ramp < 0 || ramp > order / 2) {
    throw std::invalid_argument(
        fmt::format("trapezoid of order {} needs 0 <= ramp <= {}, got {}", order, order / 2, ramp));
  }
  return symmetric_filter(order, [=](int i) { return static_cast<double>(std::min(i, ramp) + 1); });
}

Filter s_curve(int order) {
  require_order("s-curve", order, 2);
  return symmetric_filter(order, [=](int i) {
    const double t = static_cast<double>(i) / order;
    return t * t * (1.0 - t) * (1.0 - t);
  });
}

Filter hann(int order) {
  require_order("hann", order, 2);
  return symmetric_filter(order, [=](int i) { return 0.5 - 0.5 * std::cos(2.0 * pi * i / order); });
}

Filter blackman(int order) {
  require_order("blackman", order, 2);
  return symmetric_filter(order, [=](int i) { return blackman_window(i, order); });
}

Filter blackman_sinc(int order, double cutoff) {
  require_order("blackman-sinc", order, 2);
  if (!(cutoff > 0.0) || cutoff * order > 2.0 * (1.0 + 1e-12)) {
    throw std::invalid_argument(
        fmt::format("blackman-sinc of order {} needs 0 < cutoff <= {} (2/order), or taps turn negative; got {}", order,
                    2.0 / order, cutoff));
  }
  return symmetric_filter(order, [=](int i) {
    const double x = pi * cutoff * (i - 0.5 * order);
    return blackman_window(i, order) * (x == 0.0 ? 1.0 : std::max(0.0, std::sin(x) / x));
  });
}

}  // namespace accdec
