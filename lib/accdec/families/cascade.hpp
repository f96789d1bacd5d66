#pragma once

#include <array>
#include <span>

#include <accdec/filter.hpp>

namespace accdec {

/// Moving averages in series, with pairs of impulses after them (`cascade_taps`), evaluated sample by sample. The tap
/// and the sums at one sample take a few binomial coefficients: O(2^averages) instead of O(N) for all taps. A repeated
/// sum of m averages is a sum over the sets of averages,
///     sum over A of (-1)^|A| C(k - |lengths in A| + m - 1 + r, m - 1 + r) / product of the lengths,
/// with each k - .. >= 0. Here r = 0 gives the tap, r = 1 and 2 its first and second sums. As such cascades are
/// symmetric, it is taken from the nearer end, where less cancels.
class Cascade {
 public:
  /// For longer cascades, rounding leaves fewer than the nine digits needed here.
  static constexpr int order_max = 2000;

  /// @param lengths  1 to 3, each >= 1  @param pairs  0 to 2  @param pair_delay  >= 1, samples
  /// @param outer  of two pairs: the first and the last impulse, see with_pairs
  Cascade(std::span<const int> lengths, int pairs, int pair_delay, double outer = zvd_outer);

  int order() const { return order_; }
  /// b_k; 0 outside of 0 .. N.
  double tap(int k) const;
  /// B_{k+1}, the sum of the taps up to k.
  double gone(int k) const;
  /// q(m) = sum_i b_i max(m - i, 0), any m.
  double elapsed(int m) const;
  /// p(k) = sum_i b_i max(i - k, 0), any k.
  double remaining(int k) const { return elapsed(order_ - k); }

 private:
  double sum(int k, int times) const;

  struct Term {
    int offset;
    double factor;
  };
  std::array<Term, 24> terms_{};
  std::size_t count_ = 0;
  int averages_ = 0, order_ = 0;
};

/// |H| of such a cascade at x rad a sample, for any number of averages and any pairs.
/// @param pair_delays  samples, one of each pair
double cascade_response(double x, std::span<const int> lengths, std::span<const int> pair_delays);

/// Whether a corner's error at samples may be within `allowed` at this delay or any smaller one. It uses the least
/// error of all legs at least as far away, sample by sample; this is convex in the sample.
/// @param in,out  ways of a full-speed sample, as `allowed` in m
bool may_hold_error(const Cascade& cascade, double cos_interior, double in, double out, int delay, double allowed);
bool may_hold_error(const Filter& filter, double cos_interior, double in, double out, int delay, double allowed);

}  // namespace accdec
