#include <cmath>
#include <memory>

#include <coin/ClpSimplex.hpp>

#include <accdec/exact/clp_fallback.hpp>
#include <accdec/exact/stop_handler.hpp>

namespace accdec::exact {
namespace {

double clp_bound(double bound) {
  return std::isinf(bound) ? std::copysign(COIN_DBL_MAX, bound) : bound;
}

void copy(const LpRows& lp, ClpSimplex& clp) {
  clp.resize(0, lp.columns());
  for (int j = 0; j < lp.columns(); ++j) {
    clp.setColumnBounds(j, clp_bound(lp.low(j)), clp_bound(lp.high(j)));
    clp.setObjectiveCoefficient(j, lp.cost(j));
  }
  for (int r = 0; r < lp.rows(); ++r) {
    // Clp drops entries this small by itself, and then miscounts them (an assertion in CoinPackedMatrix).
    std::vector<int> columns;
    std::vector<double> values;
    for (std::size_t e = 0; e < lp.row_columns(r).size(); ++e) {
      if (std::abs(lp.row_values(r)[e]) > 1e-14)
        columns.push_back(lp.row_columns(r)[e]), values.push_back(lp.row_values(r)[e]);
    }
    const int v = lp.columns() + r;
    clp.addRow(static_cast<int>(columns.size()), columns.data(), values.data(), clp_bound(lp.low(v)),
               clp_bound(lp.high(v)));
  }
}

/// Duals of the least sum by which the rows have to be broken.
std::vector<double> least_infeasibility(const LpRows& lp, const ClpSimplex& clp) {
  ClpSimplex phase(clp);
  for (int j = 0; j < lp.columns(); ++j) phase.setObjectiveCoefficient(j, 0.0);
  for (int r = 0; r < lp.rows(); ++r) {
    const double minus = -1.0, plus = 1.0;
    if (!std::isinf(lp.high(lp.columns() + r))) phase.addColumn(1, &r, &minus, 0.0, COIN_DBL_MAX, 1.0);
    if (!std::isinf(lp.low(lp.columns() + r))) phase.addColumn(1, &r, &plus, 0.0, COIN_DBL_MAX, 1.0);
  }
  phase.allSlackBasis(true);
  phase.primal();
  if (phase.status() != 0) return {};
  const double* dual = phase.dualRowSolution();
  return {dual, dual + phase.numberRows()};
}

LpSolution solve(const LpRows& lp, const std::function<bool()>& stop) {
  using Status = DualSimplex::Status;
  ClpSimplex clp;
  clp.setLogLevel(0);
  if (const StopHandler handler(stop); stop) clp.passInEventHandler(&handler);
  clp.setPrimalTolerance(1e-10);
  clp.setDualTolerance(1e-9);
  clp.scaling(0);
  copy(lp, clp);
  clp.dual();
  if (clp.status() != 0 && clp.status() != 1 && clp.status() != 5) clp.primal();
  LpSolution solution;
  if (clp.status() == 5) solution.status = Status::stopped;
  if (clp.status() == 2) solution.status = Status::unbounded;
  if (clp.status() == 0) {
    solution.status = Status::optimal;
    solution.objective = clp.objectiveValue();
    solution.point.assign(clp.primalColumnSolution(), clp.primalColumnSolution() + lp.columns());
    solution.multipliers.assign(clp.dualRowSolution(), clp.dualRowSolution() + lp.rows());
  }
  if (clp.status() != 1) return solution;
  // Clp knows that there is no solution but not always a ray that says why, nor always of which sign.
  if (const std::unique_ptr<double[]> ray(clp.infeasibilityRay()); ray) {
    for (const double sign : {1.0, -1.0}) {
      solution.multipliers.resize(static_cast<std::size_t>(lp.rows()));
      for (int r = 0; r < lp.rows(); ++r) solution.multipliers[static_cast<std::size_t>(r)] = sign * ray[r];
      if (!lp.refutes(solution.multipliers)) continue;
      solution.status = Status::infeasible;
      return solution;
    }
  }
  solution.multipliers = least_infeasibility(lp, clp);
  if (!solution.multipliers.empty() && lp.refutes(solution.multipliers)) solution.status = Status::infeasible;
  return solution;
}

}  // namespace
}  // namespace accdec::exact

void accdec_solve_by_clp(const accdec::exact::LpRows& lp, const std::function<bool()>& stop,
                         accdec::exact::LpSolution& solution) {
  solution = accdec::exact::solve(lp, stop);
}
