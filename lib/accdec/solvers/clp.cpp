// Clp 1.17: simplex for linear problems. It is the only solver here that proves infeasibility.

#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include <ClpConfig.h>

#include <ClpEventHandler.hpp>
#include <ClpSimplex.hpp>
#include <CoinMessageHandler.hpp>
#include <CoinPackedMatrix.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/solvers/native_options.hpp>
#include <accdec/solvers/registration.hpp>
#include <accdec/solvers/run.hpp>

namespace accdec::solvers {
namespace {

using nlp::Evaluator;

/// Ends the run when the evaluator says so. Clp has limits of its own but cannot be cancelled.
class Watch : public ClpEventHandler {
 public:
  explicit Watch(Evaluator& evaluator) : evaluator_(&evaluator) {}
  ClpEventHandler* clone() const override { return new Watch(*this); }
  int event(Event) override {
    try {
      evaluator_->poll();
      return -1;
    } catch (const nlp::StopRun&) {
      return 5;
    }
  }

 private:
  Evaluator* evaluator_;
};

/// A linear problem's numbers, taken from one evaluation of everything.
struct Linear {
  std::vector<double> cost, column_lower, column_upper, row_lower, row_upper;
  double constant = 0.0;
  std::vector<int> rows, columns;
  std::vector<double> values;
};

Linear read(Evaluator& evaluator, std::span<const double> at) {
  const nlp::Problem& problem = evaluator.problem();
  const auto n = static_cast<std::size_t>(problem.num_variables()), m = static_cast<std::size_t>(problem.num_rows());
  Linear p;
  p.cost.resize(n);
  p.values.resize(problem.jacobian_pattern().size());
  std::vector<double> shift(m);
  p.constant = evaluator.objective(at);
  evaluator.gradient(at, p.cost);
  evaluator.rows(at, shift);
  evaluator.jacobian(at, p.values);
  for (std::size_t i = 0; i < n; ++i) p.constant -= p.cost[i] * at[i];
  for (std::size_t e = 0; e < p.values.size(); ++e) {
    const nlp::Entry entry = problem.jacobian_pattern()[e];
    p.rows.push_back(entry.row);
    p.columns.push_back(entry.column);
    shift[static_cast<std::size_t>(entry.row)] -= p.values[e] * at[static_cast<std::size_t>(entry.column)];
  }
  const auto push = [](nlp::Bound b, double s, std::vector<double>& lower, std::vector<double>& upper) {
    lower.push_back(std::isfinite(b.lower) ? b.lower - s : -COIN_DBL_MAX);
    upper.push_back(std::isfinite(b.upper) ? b.upper - s : COIN_DBL_MAX);
  };
  for (std::size_t i = 0; i < n; ++i)
    push(problem.variable_bound(static_cast<int>(i)), 0.0, p.column_lower, p.column_upper);
  for (std::size_t r = 0; r < m; ++r) push(problem.row_bound(static_cast<int>(r)), shift[r], p.row_lower, p.row_upper);
  return p;
}

/// Whether weights on the rows show that no point holds them all (Farkas). They do if the weighted sum of the rows,
/// within the variables' bounds, cannot reach any value that the weighted row bounds allow. This is recomputed here
/// instead of trusting Clp.
bool refutes(const Linear& p, const std::vector<double>& weights) {
  const auto extend = [](double w, double lower, double upper, double& least, double& most) {
    if (w == 0.0) return;
    const auto side = [&](double b) {
      return std::abs(b) >= COIN_DBL_MAX ? std::copysign(nlp::infinity, w * b) : w * b;
    };
    least += std::min(side(lower), side(upper));
    most += std::max(side(lower), side(upper));
  };
  std::vector<double> combined(p.cost.size(), 0.0), size(p.cost.size(), 0.0);
  for (std::size_t e = 0; e < p.values.size(); ++e) {
    const double part = weights[static_cast<std::size_t>(p.rows[e])] * p.values[e];
    combined[static_cast<std::size_t>(p.columns[e])] += part;
    size[static_cast<std::size_t>(p.columns[e])] += std::abs(part);
  }
  double row_least = 0.0, row_most = 0.0, reach_least = 0.0, reach_most = 0.0, scale = 0.0;
  for (std::size_t r = 0; r < weights.size(); ++r) {
    extend(weights[r], p.row_lower[r], p.row_upper[r], row_least, row_most);
    scale = std::max(scale, std::abs(weights[r]));
  }
  for (std::size_t i = 0; i < combined.size(); ++i) {
    // The rest of a cancelled sum is rounding.
    if (std::abs(combined[i]) <= 1e-12 * size[i]) continue;
    extend(combined[i], p.column_lower[i], p.column_upper[i], reach_least, reach_most);
  }
  const double margin = 1e-9 * scale;
  return scale > 0.0 && (reach_most < row_least - margin || reach_least > row_most + margin);
}

class ClpSolver final : public Solver {
 public:
  std::string name() const override { return "clp"; }
  std::string library_version() const override { return "Clp " CLP_VERSION; }
  std::string settings() const override {
    return "primal tolerance = feasibility_tolerance / 10, dual tolerance = tolerance, scaling 3, dual simplex";
  }
  Capabilities capabilities() const override {
    Capabilities can;
    can.linear_only = true;
    return can;
  }

 protected:
  Result do_solve(const nlp::Problem& problem, std::span<const double> start, const Options& options) const override {
    const NativeOptions native("Clp", options.native,
                               {"dual_tolerance", "max_iterations", "primal_tolerance", "scaling"});
    Evaluator evaluator(problem, limits_of(options));
    Result result;
    result.x.assign(start.begin(), start.end());
    try {
      const Linear linear = read(evaluator, start);
      run(problem, linear, evaluator, native, options, result);
      evaluator.poll();
    } catch (const nlp::StopRun&) {
    }
    conclude(evaluator, result);
    return result;
  }

 private:
  static void run(const nlp::Problem& problem, const Linear& p, Evaluator& evaluator, const NativeOptions& native,
                  const Options& options, Result& result) {
    CoinMessageHandler quiet;
    quiet.setLogLevel(0);
    ClpSimplex model;
    model.passInMessageHandler(&quiet);
    CoinPackedMatrix matrix(true, p.rows.data(), p.columns.data(), p.values.data(), static_cast<int>(p.values.size()));
    // Rows and columns after the last nonzero exist too.
    matrix.setDimensions(problem.num_rows(), problem.num_variables());
    model.loadProblem(matrix, p.column_lower.data(), p.column_upper.data(), p.cost.data(), p.row_lower.data(),
                      p.row_upper.data());
    model.setPrimalTolerance(native.get("primal_tolerance", 0.1 * options.feasibility_tolerance));
    model.setDualTolerance(native.get("dual_tolerance", std::max(1e-10, options.tolerance)));
    model.scaling(static_cast<int>(native.get("scaling", 3.0)));
    if (native.has("max_iterations")) model.setMaximumIterations(static_cast<int>(native.get("max_iterations", 0.0)));
    Watch watch(evaluator);
    model.passInEventHandler(&watch);
    model.dual();
    if (model.status() == 0 || model.status() == 2)
      model.primal();  // cleans up scaled violations; makes the unbounded ray

    result.x.assign(model.primalColumnSolution(), model.primalColumnSolution() + problem.num_variables());
    result.claimed_objective = model.objectiveValue() + p.constant;
    switch (model.status()) {
      case 0:
        result.claim = Claim::solved;
        // Clp's row prices are d(objective)/d(bound).
        for (int r = 0; r < problem.num_rows(); ++r) result.row_multipliers.push_back(-model.dualRowSolution()[r]);
        break;
      case 1:
        result.claim = Claim::infeasible;
        result.message = infeasible(problem, p, model);
        break;
      case 2:
        result.claim = Claim::unbounded;
        result.message = "Clp: unbounded";
        break;
      case 3:
        result.claim = Claim::evaluation_limit;
        result.message = "Clp: iteration limit";
        break;
      default: result.message = fmt::format("Clp: status {}", model.status());
    }
  }

  static std::string infeasible(const nlp::Problem& problem, const Linear& p, const ClpSimplex& model) {
    const std::unique_ptr<double[]> ray(model.infeasibilityRay());
    if (ray == nullptr) return "Clp: infeasible";
    const std::vector<double> weights(ray.get(), ray.get() + problem.num_rows());
    if (!refutes(p, weights)) return "Clp: infeasible, but its ray does not prove it";
    std::vector<std::string> rows;
    for (int r = 0; r < problem.num_rows(); ++r) {
      if (std::abs(weights[static_cast<std::size_t>(r)]) > 1e-9) rows.push_back(problem.row_name(r));
    }
    return fmt::format("proved infeasible: in conflict, with bounds on variables, are {}", fmt::join(rows, ", "));
  }
};

}  // namespace
}  // namespace accdec::solvers

void accdec_add_solvers(accdec::solvers::SolverList& list) {
  using namespace accdec::solvers;
  list.push_back(std::make_unique<ClpSolver>());
}
