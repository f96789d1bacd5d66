#include <algorithm>
#include <iterator>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include <accdec/design/cumulative_variables.hpp>
#include <accdec/motion/convolved.hpp>

namespace accdec {

CumulativeVariables::CumulativeVariables(int order, std::vector<double> response)
    : order_(order), response_(std::move(response)) {
  std::partial_sum(response_.begin(), response_.end(), std::back_inserter(sums_));
}

double CumulativeVariables::response_sum(int i) const {
  return i < 0 ? 0.0 : sums_[std::min(static_cast<std::size_t>(i), sums_.size() - 1)];
}

Affine CumulativeVariables::cumulative(int k) const {
  if (k <= 0) return {};
  if (k > order()) return {1.0, {}};
  Affine sum{response_sum(k - order_ - 1), {}};
  for (int j = std::max(1, k - static_cast<int>(response_.size()) + 1); j <= std::min(k, order_); ++j) {
    if (const double tap = response_[static_cast<std::size_t>(k - j)]; tap != 0.0) sum.add(j - 1, tap);
  }
  return sum;
}

Affine CumulativeVariables::remaining(int k) const {
  return Affine{1.0, {}} + -1.0 * cumulative(k);
}

Affine CumulativeVariables::tap(int i) const {
  return i < 0 || i > order() ? Affine{} : cumulative(i + 1) + -1.0 * cumulative(i);
}

Affine CumulativeVariables::remaining_moment(int k) const {
  // From sample k - i on, the filter i samples ago has as much ahead: samples before 0, and those of B up to N.
  Affine sum;
  for (int i = 0; i < static_cast<int>(response_.size()); ++i)
    sum.constant += response_[static_cast<std::size_t>(i)] * std::max(0, order_ - (k - i));
  for (int j = 1; j <= order_; ++j) {
    if (const double ahead = sums_.back() - response_sum(k - j); ahead != 0.0) sum.add(j - 1, -ahead);
  }
  return sum;
}

Affine CumulativeVariables::elapsed_moment(int m) const {
  Affine sum;
  for (int i = 0; i < static_cast<int>(response_.size()); ++i)
    sum.constant += response_[static_cast<std::size_t>(i)] * std::max(0, m - i - order_);
  for (int j = 1; j <= order_; ++j) {
    if (const double gone = response_sum(m - j); gone != 0.0) sum.add(j - 1, gone);
  }
  return sum;
}

CumulativeVariables add_cumulative_variables(QuadraticProblem& problem, int order) {
  for (int k = 1; k <= order; ++k) problem.add_variable(fmt::format("B_{}", k), {0.0, 1.0});
  return CumulativeVariables(order);
}

double largest_over_taps(const Affine& form, int order, double tap_max) {
  // B_k = b_0 + .. + b_{k-1}, so tap i has the factors of all B behind it. The largest factors get all they may have.
  std::vector<double> of_tap(static_cast<std::size_t>(order) + 1, 0.0);
  for (const auto& [variable, factor] : form.terms) of_tap[static_cast<std::size_t>(variable)] += factor;
  for (std::size_t i = of_tap.size() - 1; i > 0; --i) of_tap[i - 1] += of_tap[i];
  std::sort(of_tap.rbegin(), of_tap.rend());
  double left = 1.0, sum = form.constant;
  for (const double factor : of_tap) {
    const double tap = std::min(left, tap_max);
    sum += tap * factor;
    left -= tap;
  }
  return sum;
}

std::vector<double> motion_taps(const Response& response, std::size_t axis) {
  return convolved(response.prefilter(), response.servo(axis));
}

}  // namespace accdec
