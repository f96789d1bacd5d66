#pragma once

#include <span>
#include <vector>

namespace accdec {

/// The Acc/Dec processor: a non-negative FIR filter of order N acting on velocity commands (Shih, Chen, Lee, Eq.
/// 16-18).
///
/// Immutable. Taps are normalised to sum 1, which divides the paper's position convergent factor b_s out for good.
/// Everything the corner model asks of a filter is one of four sequences, tabulated once:
/// * cumulative(k), B_k = sum_{i<k} b_i: the step response, 0 for k <= 0 and 1 for k > N
/// * remaining(k), 1 - B_k = sum_{i>=k} b_i: summed from the far end, so that it is exactly 0 past the last tap
/// * elapsed_moment(m), Q(m) = sum_i b_i max(m - i, 0): distance gone m samples after a start, in full-speed samples
/// * remaining_moment(k), p(k) = sum_i b_i max(i - k, 0): distance left k samples after a stop was commanded
class Filter {
 public:
  /// @param taps  b_0 .. b_N, at least one, each finite and >= 0, positive sum; any scale.
  /// @throws std::invalid_argument naming the first offending tap.
  explicit Filter(std::vector<double> taps);

  /// N; the filter has N + 1 taps.
  int order() const { return static_cast<int>(taps_.size()) - 1; }
  std::span<const double> taps() const { return taps_; }
  /// b_i, 0 outside 0 .. N.
  double tap(int i) const { return i < 0 || i > order() ? 0.0 : taps_[static_cast<std::size_t>(i)]; }

  double cumulative(int k) const {
    if (k <= 0) return 0.0;
    return k > order() ? 1.0 : cumulative_[static_cast<std::size_t>(k)];
  }
  double remaining(int k) const {
    if (k <= 0) return 1.0;
    return k > order() ? 0.0 : remaining_[static_cast<std::size_t>(k)];
  }
  double elapsed_moment(int m) const {
    if (m <= 0) return 0.0;
    return m > order() ? m - mean_delay_ : elapsed_moment_[static_cast<std::size_t>(m)];
  }
  double remaining_moment(int k) const {
    if (k <= 0) return mean_delay_ - k;
    return k > order() ? 0.0 : remaining_moment_[static_cast<std::size_t>(k)];
  }

  /// Mean delay M = sum i b_i in samples; replaces N/2 of Eq. (20) for asymmetric taps.
  double mean_delay() const { return mean_delay_; }

  /// Index range [first, last] of the taps that are not exactly zero.
  int first_nonzero_tap() const { return first_nonzero_; }
  int last_nonzero_tap() const { return last_nonzero_; }

 private:
  std::vector<double> taps_, cumulative_, remaining_, elapsed_moment_, remaining_moment_;
  double mean_delay_ = 0.0;
  int first_nonzero_ = 0, last_nonzero_ = 0;
};

}  // namespace accdec
