#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include <accdec/filter.hpp>

namespace accdec {
namespace {

/// Sum that also adds up the rounding of every addition (Neumaier): exact except for the last bit.
double sum_of(const std::vector<double>& terms) {
  double sum = 0.0, lost = 0.0;
  for (const double term : terms) {
    const double next = sum + term;
    lost += std::abs(sum) >= std::abs(term) ? (sum - next) + term : (term - next) + sum;
    sum = next;
  }
  return sum + lost;
}

/// Scales the taps to sum 1. Taps that were normalised before do not change, not even in the last bit: a filter that is
/// written and read again is the same.
void normalise(std::vector<double>& taps, double largest) {
  constexpr double rounding = 4.5e-16;  // each tap was rounded once, by half of 2.2e-16 of itself, and so was the sum
  if (largest <= 1.0 && std::abs(sum_of(taps) - 1.0) <= rounding) return;
  // Scaling by the largest tap first keeps the sum finite for taps near the ends of the double range.
  for (double& b : taps) b /= largest;
  const double sum = sum_of(taps);
  for (double& b : taps) b /= sum;
}

}  // namespace

Filter::Filter(std::vector<double> taps) : Filter(std::move(taps), false) {}

Filter Filter::of_any_sign(std::vector<double> taps) {
  return Filter(std::move(taps), true);
}

Filter::Filter(std::vector<double> taps, bool any_sign) : taps_(std::move(taps)) {
  if (taps_.empty()) throw std::invalid_argument("a filter needs at least one tap");
  double largest = 0.0;
  bool negative = false;
  for (std::size_t i = 0; i < taps_.size(); ++i) {
    if (!std::isfinite(taps_[i])) throw std::invalid_argument(fmt::format("tap b_{} is not a finite number", i));
    negative = negative || taps_[i] < 0.0;
    if (taps_[i] < 0.0 && !any_sign) {
      throw std::invalid_argument(
          fmt::format("tap b_{} = {} is negative; taps must be >= 0 or the velocity command oscillates", i, taps_[i]));
    }
    largest = std::max(largest, std::abs(taps_[i]));
  }
  if (largest == 0.0 || (negative && !(sum_of(taps_) > 0.0)))
    throw std::invalid_argument("all taps are zero; their sum must be positive");

  normalise(taps_, largest);

  const std::size_t n = taps_.size();
  cumulative_.resize(n + 1);
  remaining_.resize(n + 1);
  elapsed_moment_.resize(n + 1);
  remaining_moment_.resize(n + 1);

  cumulative_[0] = 0.0;
  for (std::size_t k = 1; k <= n; ++k) cumulative_[k] = cumulative_[k - 1] + taps_[k - 1];
  // Rounding can leave the running sum an ulp above 1; a velocity limit equal to the feed would be broken.
  for (std::size_t k = 1; k <= n && !negative; ++k) cumulative_[k] = std::min(cumulative_[k], 1.0);
  cumulative_[n] = 1.0;

  remaining_[n] = 0.0;
  for (std::size_t k = n; k-- > 0;) remaining_[k] = remaining_[k + 1] + taps_[k];
  for (double& r : remaining_) r = negative ? r : std::min(r, 1.0);

  elapsed_moment_[0] = 0.0;
  for (std::size_t m = 1; m <= n; ++m) elapsed_moment_[m] = elapsed_moment_[m - 1] + cumulative_[m];

  // p(k) = p(k + 1) + (1 - B_{k+1}), from p(N) = 0: exact zeros where the motion is over.
  remaining_moment_[n] = 0.0;
  for (std::size_t k = n; k-- > 0;) remaining_moment_[k] = remaining_moment_[k + 1] + remaining_[k + 1];
  mean_delay_ = remaining_moment_[0];

  while (taps_[static_cast<std::size_t>(first_nonzero_)] == 0.0) ++first_nonzero_;
  last_nonzero_ = order();
  while (taps_[static_cast<std::size_t>(last_nonzero_)] == 0.0) --last_nonzero_;
}

}  // namespace accdec
