#include <cmath>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include <accdec/motion/controller_shapes.hpp>

namespace accdec {
namespace {

void add_pairs(std::vector<double>& taps, int pairs, int delay) {
  if (pairs < 0 || pairs > 2)
    throw std::invalid_argument(fmt::format("a shaper has 0 to 2 pairs of impulses, got {}", pairs));
  for (int p = 0; p < pairs; ++p) {
    if (delay < 1) throw std::invalid_argument(fmt::format("impulses need a delay >= 1 sample, got {}", delay));
    const std::size_t n = taps.size(), by = static_cast<std::size_t>(delay);
    taps.resize(n + by, 0.0);
    // From the end, so that what is added is still the tap before the pair.
    for (std::size_t i = n + by; i-- > by;) taps[i] += taps[i - by];
  }
}

}  // namespace

Filter exponential(int order, double ratio) {
  if (order < 0) throw std::invalid_argument(fmt::format("exponential needs order >= 0, got {}", order));
  if (!(ratio > 0.0 && ratio <= exponential_ratio_max)) {
    throw std::invalid_argument(
        fmt::format("exponential needs 0 < ratio <= {:g}, got {}", exponential_ratio_max, ratio));
  }
  std::vector<double> taps;
  // From the largest tap, so that none overflows.
  for (int i = 0; i <= order; ++i) taps.push_back(std::pow(ratio, ratio > 1.0 ? i - order : i));
  return Filter(std::move(taps));
}

Filter gaussian(int order, double alpha) {
  if (order < 1) throw std::invalid_argument(fmt::format("gaussian needs order >= 1, got {}", order));
  if (!(alpha >= 0.0 && alpha <= 6.0))
    throw std::invalid_argument(fmt::format("gaussian needs 0 <= alpha <= 6, got {}", alpha));
  std::vector<double> taps;
  for (int i = 0; i <= order; ++i) {
    // From the end that is nearer, so that the taps are symmetric to the last bit.
    const double x = alpha * (1.0 - 2.0 * std::min(i, order - i) / static_cast<double>(order));
    taps.push_back(std::exp(-0.5 * x * x));
  }
  return Filter(std::move(taps));
}

std::vector<double> cascade_taps(std::span<const int> lengths, int pairs, int delay) {
  if (lengths.empty()) throw std::invalid_argument("a cascade of averages needs at least one length");
  // Whole numbers: sums of products of lengths, exact up to 2^53, so that the taps are symmetric.
  std::vector<double> taps{1.0}, next;
  for (const int length : lengths) {
    if (length < 1) throw std::invalid_argument(fmt::format("an average needs a length >= 1, got {}", length));
    const std::size_t n = taps.size(), m = static_cast<std::size_t>(length);
    next.resize(n + m - 1);
    double sum = 0.0;
    for (std::size_t i = 0; i < next.size(); ++i) {
      if (i < n) sum += taps[i];
      if (i >= m) sum -= taps[i - m];
      next[i] = sum;
    }
    taps.swap(next);
  }
  add_pairs(taps, pairs, delay);
  return taps;
}

Filter averages(std::span<const int> lengths) {
  return Filter(cascade_taps(lengths, 0, 0));
}

Filter with_pairs(const Filter& filter, int pairs, int delay) {
  std::vector<double> taps(filter.taps().begin(), filter.taps().end());
  add_pairs(taps, pairs, delay);
  return Filter(std::move(taps));
}

}  // namespace accdec
