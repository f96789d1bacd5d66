#include <algorithm>
#include <cmath>
#include <vector>

#include <accdec/nlp/violation.hpp>

namespace accdec::nlp {

double largest_violation(const Problem& problem, std::span<const double> x) {
  std::vector<double> rows(static_cast<std::size_t>(problem.num_rows()));
  problem.rows(x, rows);
  double worst = 0.0;
  const auto judge = [&](Bound b, double v) {
    worst = std::isfinite(v) ? std::max({worst, b.lower - v, v - b.upper}) : infinity;
  };
  for (int r = 0; r < problem.num_rows(); ++r) judge(problem.row_bound(r), rows[static_cast<std::size_t>(r)]);
  for (int i = 0; i < problem.num_variables(); ++i) judge(problem.variable_bound(i), x[static_cast<std::size_t>(i)]);
  return worst;
}

bool materially_better(double objective, double other) {
  return objective < other - 1e-6 * std::max(1.0, std::abs(other));
}

}  // namespace accdec::nlp
