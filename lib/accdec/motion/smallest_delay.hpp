#pragma once

#include <vector>

#include <accdec/motion/filter.hpp>

namespace accdec {

/// Smallest command delay that brings a corner's error at samples within a bound, for a fixed filter (or pair), found
/// directly: built once per filter, then called for millions of corners. Copies what it needs; const calls from many
/// threads are safe.
///
/// For every sample k the law of cosines gives the farthest leg 2 may have come, q_max(P(k)), and so the smallest real
/// delay d(k) = k - Qinv(q_max(P(k))), Q interpolated linearly. The path (P(k), Q(k - d)) is a convex curve and q_max
/// is concave, so the k with d(k) <= D are consecutive for every D: d(k) falls, then rises, and its minimum is
/// bracketed by doubling steps from a guess and then narrowed by golden section, each step one square root and one
/// table look-up for Qinv: O(log N).
///
/// Up to 90 deg the answer is the minimum rounded up. On flat corners a whole number of samples may step over the ball,
/// so delays are tried one by one from there, each from the nearest sample of the one before. One or two suffice unless
/// the tolerance is far below the distance moved in a sample; the worst case, an almost straight pass with such a
/// tolerance, tries O(N) delays.
class DelayFinder {
 public:
  explicit DelayFinder(const Filter& filter) : DelayFinder(filter, filter) {}
  DelayFinder(const Filter& filter_in, const Filter& filter_out);

  /// @param cos_interior  cos(theta), -1 .. 1
  /// @param step_in       v1 T, m, > 0: length of a full-speed sample of leg 1
  /// @param step_out      v2 T, m, > 0
  /// @param error_max     bound on min_k |S[k]|, m, >= 0 (a negative bound or NaN is taken as 0)
  /// @return the smallest d >= 0 with corner error <= error_max, ties by rounding aside (1e-12 of the bound); never
  /// more
  ///         than the d of an exact stop. The error of the delay returned, as computed by `corner_error`, satisfies the
  ///         bound to the last bit.
  int operator()(double cos_interior, double step_in, double step_out, double error_max) const;

  /// The delay from which on the motion stops exactly in the corner: last non-zero tap of leg 1's filter less first of
  /// leg 2's, and at least 0.
  int exact_stop_delay() const { return stop_delay_; }

 private:
  /// A convex, non-decreasing sequence from 0 and its inverse by a table uniform in the square root of the value, in
  /// which the parabolic ends of usual Acc/Dec shapes are evenly spread.
  class Ramp {
   public:
    explicit Ramp(const std::vector<double>& values);
    double operator[](int m) const { return points_[static_cast<std::size_t>(m)].value; }
    double top() const { return points_.back().value; }
    int last() const { return static_cast<int>(points_.size()) - 1; }
    /// Largest m with value <= x, for 0 <= x < top. Expected O(1), never more than O(log size).
    int floor(double x) const;
    /// Real m by linear interpolation; beyond the top the sequence goes on with slope 1.
    double inverse(double x) const;

   private:
    struct Point {
      double value, per_step;  ///< and 1 / (next value - value)
    };
    std::vector<Point> points_;
    std::vector<int> cell_;  ///< largest m whose value lies in an earlier cell
    double scale_ = 0.0;
  };

  Ramp in_;   ///< in_[m] = remaining_moment(last_ - m) of leg 1's filter
  Ramp out_;  ///< out_[m] = elapsed_moment(m + first_) of leg 2's
  int last_, first_, stop_delay_;
  double mean_delay_out_;
  double exponent_ = 2.0;
};

}  // namespace accdec
