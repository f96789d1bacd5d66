#include <algorithm>
#include <cmath>

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>

#include <accdec/nlp/kkt.hpp>
#include <accdec/nlp/nonnegative.hpp>

namespace accdec::nlp {
namespace {

using Vector = Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;

/// Up to here a dense active-set estimate of the multipliers takes well under a second.
constexpr int dense_variables = 120;

struct KktPoint {
  std::span<const double> x;
  Vector gradient, rows;
  Sparse jacobian;
};

bool near(double a, double b, double tolerance) {
  return std::isfinite(b) && std::abs(a - b) <= tolerance * std::max(1.0, std::abs(b));
}

/// The part of the Lagrangian gradient that no bound multiplier can cancel. A variable at distance s from its bound has
/// a multiplier r with the complementarity |r| s. Interior-point methods leave this at about their barrier parameter.
double projected(double r, double x, Bound b, double tolerance, double scale) {
  if (b.lower == b.upper) return 0.0;
  if (near(x, b.lower, tolerance) || x < b.lower) return std::max(0.0, -r);
  if (near(x, b.upper, tolerance) || x > b.upper) return std::max(0.0, r);
  const double distance = r > 0.0 ? x - b.lower : b.upper - x;
  return std::abs(r) * distance <= 0.01 * tolerance * scale ? 0.0 : std::abs(r);
}

void measure(const Problem& problem, const KktPoint& p, const Vector& y, double tolerance, KktReport& report) {
  const Vector residual = p.gradient + p.jacobian.transpose() * y;
  // The scale does not use the multipliers: where two rows nearly pinch the feasible set, huge opposite multipliers
  // would make any point stationary.
  const double scale = std::max(1.0, p.gradient.size() > 0 ? p.gradient.cwiseAbs().maxCoeff() : 0.0);
  double stationarity = 0.0, complementarity = 0.0;
  for (Eigen::Index i = 0; i < residual.size(); ++i) {
    const int v = static_cast<int>(i);
    stationarity = std::max(stationarity, projected(residual[i], p.x[static_cast<std::size_t>(i)],
                                                    problem.variable_bound(v), tolerance, scale));
  }
  for (Eigen::Index i = 0; i < y.size(); ++i) {
    const Bound b = problem.row_bound(static_cast<int>(i));
    if (b.lower == b.upper || y[i] == 0.0) continue;
    const double side = y[i] > 0.0 ? b.upper : b.lower;
    // A multiplier on a side that does not exist fits no complementarity at all.
    complementarity =
        std::max(complementarity, std::isfinite(side) ? std::abs(y[i] * (p.rows[i] - side)) : std::abs(y[i]));
  }
  report.stationarity = stationarity / scale;
  report.complementarity = complementarity / scale;
  report.multipliers.assign(y.data(), y.data() + y.size());
}

/// Minimises |g + J_A^T y| over active rows A and variables off their bounds, with the signs of active sides. It solves
/// the least squares problem, drops rows with a wrong sign, and solves again for the others.
Vector estimate(const Problem& problem, const KktPoint& p, double tolerance) {
  const Eigen::Index n = p.gradient.size(), m = p.rows.size();
  std::vector<char> active(static_cast<std::size_t>(m), 0), open(static_cast<std::size_t>(n), 1);
  for (int i = 0; i < problem.num_variables(); ++i) {
    const Bound b = problem.variable_bound(i);
    const double x = p.x[static_cast<std::size_t>(i)];
    if (b.lower == b.upper || near(x, b.lower, tolerance) || near(x, b.upper, tolerance))
      open[static_cast<std::size_t>(i)] = 0;
  }
  for (Eigen::Index r = 0; r < m; ++r) {
    const Bound b = problem.row_bound(static_cast<int>(r));
    active[static_cast<std::size_t>(r)] = near(p.rows[r], b.lower, tolerance) || near(p.rows[r], b.upper, tolerance);
  }
  Vector y = Vector::Zero(m);
  for (int round = 0; round < 30; ++round) {
    std::vector<Eigen::Index> kept;
    std::vector<Eigen::Index> column(static_cast<std::size_t>(m), -1);
    for (Eigen::Index r = 0; r < m; ++r) {
      if (!active[static_cast<std::size_t>(r)]) continue;
      column[static_cast<std::size_t>(r)] = static_cast<Eigen::Index>(kept.size());
      kept.push_back(r);
    }
    y.setZero();
    if (kept.empty()) return y;
    std::vector<Eigen::Triplet<double>> entries;
    for (int k = 0; k < p.jacobian.outerSize(); ++k) {
      for (Sparse::InnerIterator it(p.jacobian, k); it; ++it) {
        const auto r = static_cast<std::size_t>(it.row());
        if (active[r] && open[static_cast<std::size_t>(it.col())])
          entries.emplace_back(it.col(), column[r], it.value());
      }
    }
    Sparse a(n, static_cast<Eigen::Index>(kept.size()));
    a.setFromTriplets(entries.begin(), entries.end());
    Vector target = -p.gradient;
    for (Eigen::Index i = 0; i < n; ++i) {
      if (!open[static_cast<std::size_t>(i)]) target[i] = 0.0;
    }
    Eigen::LeastSquaresConjugateGradient<Sparse> solver(a);
    solver.setTolerance(1e-14);
    solver.setMaxIterations(static_cast<Eigen::Index>(4 * kept.size() + 100));
    const Vector part = solver.solve(target);
    bool wrong = false;
    for (std::size_t i = 0; i < kept.size(); ++i) {
      const Eigen::Index r = kept[i];
      const Bound b = problem.row_bound(static_cast<int>(r));
      const double value = part[static_cast<Eigen::Index>(i)];
      const bool lower = near(p.rows[r], b.lower, tolerance), upper = near(p.rows[r], b.upper, tolerance);
      if ((value > 0.0 && !upper) || (value < 0.0 && !lower)) {
        active[static_cast<std::size_t>(r)] = 0;
        wrong = true;
      } else {
        y[r] = value;
      }
    }
    if (!wrong) break;
  }
  return y;
}

/// The same, exactly, with the multipliers of active bounds as separate unknowns. A degenerate vertex has many
/// multipliers of rows. The smallest of them need not leave the bounds' multipliers with the right signs. Dense, for
/// small problems.
Vector estimate_exactly(const Problem& problem, const KktPoint& p, double tolerance) {
  const Eigen::Index n = p.gradient.size(), m = p.rows.size();
  std::vector<Vector> columns;
  std::vector<char> signed_column;
  std::vector<std::pair<Eigen::Index, double>> rows;  // row and sign of its multiplier, columns first
  const Eigen::MatrixXd jacobian(p.jacobian);
  const auto open = [&](Vector v) {
    for (int i = 0; i < problem.num_variables(); ++i) {
      const Bound b = problem.variable_bound(i);
      if (b.lower == b.upper) v[i] = 0.0;
    }
    return v;
  };
  for (Eigen::Index r = 0; r < m; ++r) {
    const Bound b = problem.row_bound(static_cast<int>(r));
    const bool lower = near(p.rows[r], b.lower, tolerance), upper = near(p.rows[r], b.upper, tolerance);
    if (!lower && !upper) continue;
    const double sign = upper ? 1.0 : -1.0;
    rows.emplace_back(r, sign);
    columns.push_back(open(sign * jacobian.row(r).transpose()));
    signed_column.push_back(!(lower && upper));
  }
  for (int i = 0; i < problem.num_variables(); ++i) {
    const Bound b = problem.variable_bound(i);
    const double x = p.x[static_cast<std::size_t>(i)];
    const bool lower = near(x, b.lower, tolerance) || x < b.lower, upper = near(x, b.upper, tolerance) || x > b.upper;
    if (b.lower == b.upper || (!lower && !upper)) continue;
    columns.push_back(Vector::Unit(n, i) * (upper ? 1.0 : -1.0));
    signed_column.push_back(!(lower && upper));
  }
  Vector y = Vector::Zero(m);
  if (columns.empty()) return y;
  Eigen::MatrixXd a(n, static_cast<Eigen::Index>(columns.size()));
  for (std::size_t j = 0; j < columns.size(); ++j) a.col(static_cast<Eigen::Index>(j)) = columns[j];
  const Vector w = nonnegative_least_squares(a, open(-p.gradient), signed_column);
  for (std::size_t j = 0; j < rows.size(); ++j) y[rows[j].first] = rows[j].second * w[static_cast<Eigen::Index>(j)];
  return y;
}

}  // namespace

KktReport check_kkt(const Problem& problem, std::span<const double> x, std::span<const double> multipliers,
                    double tolerance) {
  KktReport report;
  const int n = problem.num_variables(), m = problem.num_rows();
  const auto all_finite = [](std::span<const double> v) {
    return std::all_of(v.begin(), v.end(), [](double a) { return std::isfinite(a); });
  };
  if (static_cast<int>(x.size()) != n || !all_finite(x)) return report;

  KktPoint p{x, Vector::Zero(n), Vector::Zero(m), Sparse(m, n)};
  report.objective = problem.objective(x);
  problem.rows(x, {p.rows.data(), static_cast<std::size_t>(m)});
  if (!std::isfinite(report.objective) || !p.rows.allFinite()) return report;
  report.finite = true;

  double worst = 0.0;
  const auto offend = [&](double violation, double& largest, const std::string& name) {
    largest = std::max(largest, violation);
    if (violation > worst) worst = violation, report.worst = name;
  };
  for (int i = 0; i < n; ++i) {
    const Bound b = problem.variable_bound(i);
    const double v = x[static_cast<std::size_t>(i)];
    const double violation = std::max({0.0, b.lower - v, v - b.upper});
    if (violation > 0.0) offend(violation, report.bound_violation, problem.variable_name(i));
  }
  for (int r = 0; r < m; ++r) {
    const Bound b = problem.row_bound(r);
    const double violation = std::max({0.0, b.lower - p.rows[r], p.rows[r] - b.upper});
    if (violation > 0.0) offend(violation, report.row_violation, problem.row_name(r));
  }

  std::vector<double> values(problem.jacobian_pattern().size());
  problem.gradient(x, {p.gradient.data(), static_cast<std::size_t>(n)});
  problem.jacobian(x, values);
  report.stationarity = report.complementarity = infinity;
  if (!p.gradient.allFinite() || !all_finite(values)) return report;
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t k = 0; k < values.size(); ++k) {
    entries.emplace_back(problem.jacobian_pattern()[k].row, problem.jacobian_pattern()[k].column, values[k]);
  }
  p.jacobian.setFromTriplets(entries.begin(), entries.end());

  const auto merit = [](const KktReport& r) { return std::max(r.stationarity, r.complementarity); };
  if (static_cast<int>(multipliers.size()) == m && all_finite(multipliers)) {
    measure(problem, p, Eigen::Map<const Vector>(multipliers.data(), m), tolerance, report);
    if (merit(report) <= tolerance) return report;
  }
  KktReport second = report;
  measure(problem, p, estimate(problem, p, tolerance), tolerance, second);
  KktReport best = merit(second) < merit(report) ? second : report;
  if (merit(best) > tolerance && n <= dense_variables) {
    measure(problem, p, estimate_exactly(problem, p, tolerance), tolerance, second);
    if (merit(second) < merit(best)) return second;
  }
  return best;
}

}  // namespace accdec::nlp
