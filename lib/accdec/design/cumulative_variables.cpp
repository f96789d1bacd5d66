#include <algorithm>

#include <fmt/format.h>

#include <accdec/design/cumulative_variables.hpp>
#include <accdec/motion/convolved.hpp>

namespace accdec {

template <class Form>
Affine CumulativeVariables::convolved(const Form& form) const {
  if (response_.size() == 1) return form(0);
  Affine sum;
  std::vector<double> dense(static_cast<std::size_t>(order_), 0.0);
  for (std::size_t i = 0; i < response_.size(); ++i) {
    const Affine ago = form(static_cast<int>(i));
    sum.constant += response_[i] * ago.constant;
    for (const auto& [variable, factor] : ago.terms) dense[static_cast<std::size_t>(variable)] += response_[i] * factor;
  }
  for (std::size_t i = 0; i < dense.size(); ++i) {
    if (dense[i] != 0.0) sum.add(static_cast<int>(i), dense[i]);
  }
  return sum;
}

Affine CumulativeVariables::cumulative(int k) const {
  if (k <= 0) return {};
  if (k > order()) return {1.0, {}};
  return convolved([&](int ago) {
    const int at = k - ago;
    return at <= 0 ? Affine{} : at > order_ ? Affine{1.0, {}} : Affine{0.0, {{at - 1, 1.0}}};
  });
}

Affine CumulativeVariables::remaining(int k) const {
  return Affine{1.0, {}} + -1.0 * cumulative(k);
}

Affine CumulativeVariables::tap(int i) const {
  return i < 0 || i > order() ? Affine{} : cumulative(i + 1) + -1.0 * cumulative(i);
}

Affine CumulativeVariables::remaining_moment(int k) const {
  return convolved([&](int ago) {
    const int at = k - ago;
    Affine sum{static_cast<double>(std::max(0, -at)), {}};
    for (int j = std::max(at, 0) + 1; j <= order_; ++j) {
      sum.constant += 1.0;
      sum.add(j - 1, -1.0);
    }
    return sum;
  });
}

Affine CumulativeVariables::elapsed_moment(int m) const {
  return convolved([&](int ago) {
    const int at = m - ago;
    Affine sum{static_cast<double>(std::max(0, at - order_)), {}};
    for (int j = 1; j <= std::min(at, order_); ++j) sum.add(j - 1, 1.0);
    return sum;
  });
}

CumulativeVariables add_cumulative_variables(QuadraticProblem& problem, int order) {
  for (int k = 1; k <= order; ++k) problem.add_variable(fmt::format("B_{}", k), {0.0, 1.0});
  return CumulativeVariables(order);
}

std::vector<double> motion_taps(const Response& response, std::size_t axis) {
  return convolved(response.prefilter(), response.servo(axis));
}

}  // namespace accdec
