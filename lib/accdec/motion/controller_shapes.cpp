#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include <accdec/filter.hpp>
#include <accdec/motion/windows.hpp>

namespace accdec {
namespace {

void check_pairs(int pairs, double outer) {
  if (pairs < 0 || pairs > 2)
    throw std::invalid_argument(fmt::format("a shaper has 0 to 2 pairs of impulses, got {}", pairs));
  if (!(outer > 0.0 && outer < 0.5))
    throw std::invalid_argument(fmt::format("the first of three impulses is above 0 and below 1/2, got {}", outer));
}

/// Behind it the taps have 2^pairs times their sum.
void add_pairs(std::vector<double>& taps, int pairs, int delay, double outer) {
  check_pairs(pairs, outer);
  const std::vector<double> single = pairs == 2 && outer != zvd_outer ? taps : std::vector<double>{};
  for (int p = 0; p < pairs; ++p) {
    if (delay < 1) throw std::invalid_argument(fmt::format("impulses need a delay >= 1 sample, got {}", delay));
    const std::size_t n = taps.size(), by = static_cast<std::size_t>(delay);
    taps.resize(n + by, 0.0);
    // Goes from the end, so that the added tap is still the one before the pair.
    for (std::size_t i = n + by; i-- > by;) taps[i] += taps[i - by];
  }
  if (pairs < 2 || outer == zvd_outer) return;
  const std::size_t by = static_cast<std::size_t>(delay), n = single.size();
  std::fill(taps.begin(), taps.end(), 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    taps[i] += 4.0 * outer * single[i];
    taps[i + by] += (4.0 - 8.0 * outer) * single[i];
    taps[i + 2 * by] += 4.0 * outer * single[i];
  }
}

/// Taps behind impulses that need not be at whole samples.
std::vector<double> with_split_pairs(const std::vector<double>& taps, int pairs, double delay, double outer) {
  check_pairs(pairs, outer);
  const double weights[2][3] = {{0.5, 0.5, 0.0}, {outer, 1.0 - 2.0 * outer, outer}};
  std::vector<double> sum(taps.size() + static_cast<std::size_t>(std::ceil(pairs * delay - shaper_snap)), 0.0);
  for (int m = 0; m <= pairs; ++m) {
    const double at = m * delay, first = std::floor(at + shaper_snap);
    const double later = at - first < shaper_snap ? 0.0 : at - first, weight = weights[pairs - 1][m];
    const auto by = static_cast<std::size_t>(first);
    for (std::size_t i = 0; i < taps.size(); ++i) {
      sum[i + by] += weight * (1.0 - later) * taps[i];
      if (later > 0.0) sum[i + by + 1] += weight * later * taps[i];
    }
  }
  return sum;
}

/// The sums of up to `length` neighbours of symmetric taps. Only sums of numbers >= 0 from both ends of blocks, nothing
/// is subtracted: the smallest sum is as accurate as the largest (van Herk, Pattern Recognition Letters 13, 1992).
/// Whole numbers are exact up to 2^53.
std::vector<double> moving_sums(const std::vector<double>& taps, std::size_t length) {
  if (length == 1) return taps;
  const std::size_t size = taps.size() + length - 1, half = (size + 1) / 2;
  std::vector<double> sums(size, 0.0), from_right(length);
  std::copy_n(taps.begin(), std::min(half, taps.size()), sums.begin());
  for (std::size_t block = 0; block < half; block += length) {
    const std::size_t end = std::min(half, block + length);
    double left = 0.0;
    for (std::size_t i = block; i < end; ++i) {
      left += sums[i];
      // The window of sum i begins `length` - 1 before it, in the block before.
      const std::size_t begin = i - block + 1;
      sums[i] = left + (block > 0 && begin < length ? from_right[begin] : 0.0);
    }
    if (block + length >= half) break;
    double right = 0.0;
    for (std::size_t i = length; i-- > 0;) {
      right += block + i < taps.size() ? taps[block + i] : 0.0;
      from_right[i] = right;
    }
  }
  for (std::size_t i = half; i < size; ++i) sums[i] = sums[size - 1 - i];
  return sums;
}

}  // namespace

Filter exponential(int order, double ratio) {
  if (order < 0) throw std::invalid_argument(fmt::format("exponential needs order >= 0, got {}", order));
  if (!(ratio > 0.0 && ratio <= exponential_ratio_max)) {
    throw std::invalid_argument(
        fmt::format("exponential needs 0 < ratio <= {:g}, got {}", exponential_ratio_max, ratio));
  }
  std::vector<double> taps;
  // Powers are relative to the largest tap, so that none overflows.
  for (int i = 0; i <= order; ++i) taps.push_back(std::pow(ratio, ratio > 1.0 ? i - order : i));
  return Filter(std::move(taps));
}

double gaussian_window(int i, int order, double alpha) {
  // Measured from the nearer end.
  const double x = alpha * (1.0 - 2.0 * std::min(i, order - i) / static_cast<double>(order));
  return std::exp(-0.5 * x * x);
}

Filter gaussian(int order, double alpha) {
  if (order < 1) throw std::invalid_argument(fmt::format("gaussian needs order >= 1, got {}", order));
  if (!(alpha >= 0.0 && alpha <= gaussian_alpha_max))
    throw std::invalid_argument(fmt::format("gaussian needs 0 <= alpha <= {}, got {}", gaussian_alpha_max, alpha));
  std::vector<double> taps;
  for (int i = 0; i <= order; ++i) taps.push_back(gaussian_window(i, order, alpha));
  return Filter(std::move(taps));
}

std::vector<double> cascade_taps(std::span<const int> lengths, int pairs, int delay, double outer) {
  if (lengths.empty()) throw std::invalid_argument("a cascade of averages needs at least one length");
  if (lengths.size() > averages_max) {
    throw std::invalid_argument(
        fmt::format("a cascade has at most {} averages, got {} lengths", averages_max, lengths.size()));
  }
  double order = 0.0;
  for (const int length : lengths) {
    if (length < 1) throw std::invalid_argument(fmt::format("an average needs a length >= 1, got {}", length));
    order += length - 1.0;
  }
  if (order * static_cast<double>(lengths.size()) > averages_work_max) {
    throw std::invalid_argument(
        fmt::format("a cascade of {} averages has at most order {:.0f}, got {:.0f}", lengths.size(),
                    std::floor(averages_work_max / static_cast<double>(lengths.size())), order));
  }
  std::vector<double> taps{1.0};
  for (const int length : lengths) {
    taps = moving_sums(taps, static_cast<std::size_t>(length));
    // A power of two changes no digit; the middle tap is the largest.
    constexpr double large = 0x1p500;
    if (taps[taps.size() / 2] > large) {
      for (double& b : taps) b /= large;
    }
  }
  add_pairs(taps, pairs, delay, outer);
  return taps;
}

Filter averages(std::span<const int> lengths) {
  return Filter(cascade_taps(lengths, 0, 0));
}

Filter with_pairs(const Filter& filter, int pairs, double delay, double outer) {
  std::vector<double> taps(filter.taps().begin(), filter.taps().end());
  const double whole = std::floor(delay);
  if (delay == whole || !(delay >= 1.0))
    add_pairs(taps, pairs, static_cast<int>(std::clamp(whole, -1e9, 1e9)), outer);
  else if (pairs != 0)
    taps = with_split_pairs(taps, pairs, delay, outer);
  return Filter(std::move(taps));
}

}  // namespace accdec
