#pragma once

#include <vector>

#include <accdec/design/quadratic_problem.hpp>
#include <accdec/machine/response.hpp>

namespace accdec {

/// Cumulative response B_1 .. B_N of the designed filter as variables 0 .. N-1; B_k for k <= 0 and k > N are the
/// constants 0 and 1. Behind taps r of a response it is sum_i r_i B_{k-i}, of order N + R.
class CumulativeVariables {
 public:
  explicit CumulativeVariables(int order, std::vector<double> response = {1.0});
  /// The same filter behind other taps.
  CumulativeVariables behind(std::vector<double> response) const { return CumulativeVariables(order_, response); }
  int order() const { return order_ + static_cast<int>(response_.size()) - 1; }
  Affine cumulative(int k) const;
  Affine remaining(int k) const;         ///< 1 - B_k
  Affine tap(int i) const;               ///< b_i = B_{i+1} - B_i; 0 outside 0 .. N
  Affine remaining_moment(int k) const;  ///< p(k) = sum_{j > k} (1 - B_j), dense
  Affine elapsed_moment(int m) const;    ///< Q(m) = sum_{j <= m} B_j, dense

 private:
  double response_sum(int i) const;  ///< r_0 + ... + r_i

  int order_;
  std::vector<double> response_, sums_;
};

/// Adds B_1 .. B_N to an empty problem.
CumulativeVariables add_cumulative_variables(QuadraticProblem& problem, int order);

/// Largest value of a form of B_1 .. B_N for any filter whose taps are at most `tap_max`.
double largest_over_taps(const Affine& form, int order, double tap_max);

/// The taps from the designed filter to the motion of an axis: the control's smoothing, then its servo.
std::vector<double> motion_taps(const Response& response, std::size_t axis);

}  // namespace accdec
