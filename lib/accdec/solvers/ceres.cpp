// Ceres 2.1: trust-region least squares within bounds, driven to constrained problems by an augmented Lagrangian.
//
// Rows enter as residuals sqrt(rho) (s - clamp(s, lower, upper)) with s = c + y / rho. This is the usual augmented
// Lagrangian for equality and inequality rows (Nocedal and Wright, Numerical Optimization, 2nd ed., section 17.4). Its
// multipliers become y <- rho (s - clamp(s)). If the objective is a sum of squares, its residuals enter. Any other
// objective enters as one residual f - target, with a target below the optimum. The square grows with f wherever f >
// target. A run that reaches its target starts again with a lower one.

#include <algorithm>
#include <cmath>

#include <ceres/ceres.h>
#include <fmt/format.h>

#include <accdec/solvers/free_variables.hpp>
#include <accdec/solvers/native_options.hpp>
#include <accdec/solvers/registration.hpp>
#include <accdec/solvers/run.hpp>

namespace accdec::solvers {
namespace {

using nlp::Evaluator;

/// Weights and shifts of one augmented Lagrangian; the cost function reads them at every call.
struct Shape {
  double penalty = 1.0, target = 0.0;
  std::vector<double> multipliers;

  /// How far row r, at value c and shifted by its multiplier, lies outside its bounds.
  double shifted(const nlp::Bound& b, double c, std::size_t r) const {
    const double s = c + multipliers[r] / penalty;
    return s - std::clamp(s, b.lower, b.upper);
  }
};

class Cost final : public ceres::CostFunction {
 public:
  Cost(Evaluator& evaluator, FreeVariables& free, const Shape& shape)
      : evaluator_(evaluator),
        free_(free),
        shape_(shape),
        squares_(evaluator.problem().num_residuals()),
        objective_(std::max(1, squares_)) {
    const nlp::Problem& problem = evaluator.problem();
    set_num_residuals(objective_ + problem.num_rows());
    mutable_parameter_block_sizes()->push_back(static_cast<int>(free.size()));
    rows_.resize(static_cast<std::size_t>(problem.num_rows()));
    jacobian_.resize(problem.jacobian_pattern().size());
    gradient_.resize(static_cast<std::size_t>(objective_) * static_cast<std::size_t>(problem.num_variables()));
  }

  // Ceres reports a failed evaluation on standard error, even when told to be silent. So after a stop every call
  // succeeds at once with zeros, and the callback below ends the run.
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    try {
      evaluate(free_.expand(parameters[0]), residuals, jacobians != nullptr ? jacobians[0] : nullptr);
      return true;
    } catch (const nlp::StopRun&) {
      std::fill_n(residuals, num_residuals(), 0.0);
      if (jacobians != nullptr && jacobians[0] != nullptr) {
        std::fill_n(jacobians[0], static_cast<std::size_t>(num_residuals()) * free_.size(), 0.0);
      }
      return true;
    }
  }

 private:
  void evaluate(const std::vector<double>& x, double* residuals, double* jacobian) const {
    const nlp::Problem& problem = evaluator_.problem();
    // The objective is always evaluated: limits count its evaluations, and it ranks the feasible points.
    const double f = evaluator_.objective(x);
    if (squares_ > 0) {
      evaluator_.residuals(x, {residuals, static_cast<std::size_t>(squares_)});
    } else {
      residuals[0] = f - shape_.target;
    }
    if (!rows_.empty()) evaluator_.rows(x, rows_);
    const double weight = std::sqrt(shape_.penalty);
    for (std::size_t r = 0; r < rows_.size(); ++r) {
      residuals[static_cast<std::size_t>(objective_) + r] =
          weight * shape_.shifted(problem.row_bound(static_cast<int>(r)), rows_[r], r);
    }
    if (jacobian == nullptr) return;
    const std::size_t n = free_.size(), all = x.size();
    std::fill_n(jacobian, static_cast<std::size_t>(num_residuals()) * n, 0.0);
    squares_ > 0 ? evaluator_.residual_jacobian(x, gradient_) : evaluator_.gradient(x, gradient_);
    for (std::size_t r = 0; r < static_cast<std::size_t>(objective_); ++r)
      free_.restrict({&gradient_[r * all], all}, jacobian + r * n);
    if (rows_.empty()) return;
    evaluator_.jacobian(x, jacobian_);
    for (std::size_t e = 0; e < jacobian_.size(); ++e) {
      const nlp::Entry entry = problem.jacobian_pattern()[e];
      const auto r = static_cast<std::size_t>(entry.row);
      const int column = free_.position(entry.column);
      if (column < 0 || residuals[static_cast<std::size_t>(objective_) + r] == 0.0) continue;
      jacobian[(static_cast<std::size_t>(objective_) + r) * n + static_cast<std::size_t>(column)] +=
          weight * jacobian_[e];
    }
  }

  Evaluator& evaluator_;
  FreeVariables& free_;
  const Shape& shape_;
  int squares_, objective_;
  mutable std::vector<double> rows_, jacobian_, gradient_;
};

class StopWatch final : public ceres::IterationCallback {
 public:
  explicit StopWatch(const Evaluator& evaluator) : evaluator_(evaluator) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary&) override {
    return evaluator_.stop() == nlp::Stop::none ? ceres::SOLVER_CONTINUE : ceres::SOLVER_TERMINATE_SUCCESSFULLY;
  }

 private:
  const Evaluator& evaluator_;
};

/// The outer iteration of the augmented Lagrangian.
class Run {
 public:
  Run(Evaluator& evaluator, FreeVariables& free, const NativeOptions& native, const Options& options, Result& result)
      : evaluator_(evaluator), free_(free), native_(native), options_(options), result_(result) {}

  void go(std::span<const double> start) {
    const nlp::Problem& problem = evaluator_.problem();
    const auto m = static_cast<std::size_t>(problem.num_rows());
    rows_.resize(m);
    shape_.multipliers.assign(m, 0.0);
    shape_.penalty = native_.get("penalty", 10.0);
    squares_ = problem.num_residuals() > 0;
    const double first = evaluator_.objective(start);
    depth_ = std::max(1.0, std::abs(first));
    if (!squares_) shape_.target = first - depth_;

    ceres::Problem::Options own;
    own.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    Cost cost(evaluator_, free_, shape_);
    ceres::Problem least_squares(own);
    std::vector<double> x = free_.restrict(start);
    least_squares.AddParameterBlock(x.data(), static_cast<int>(x.size()));
    least_squares.AddResidualBlock(&cost, nullptr, x.data());
    set_bounds(least_squares, x);

    const double most = options_.own_budget ? 200.0 : 1e9;
    const int rounds = static_cast<int>(std::min(1e9, native_.get("outer_iterations", most)));
    StopWatch watch(evaluator_);
    for (int round = 0; round < rounds; ++round) {
      ceres::Solver::Summary summary;
      ceres::Solve(settings(&watch), &least_squares, &summary);
      result_.x = free_.expand(x.data());
      evaluator_.poll();
      if (judge(summary)) return;
    }
    update();
    end(Claim::evaluation_limit, fmt::format("outer iteration limit, violation {:.3g}", violation_));
  }

 private:
  /// Always true, for `judge`.
  bool end(Claim claim, std::string message) {
    result_.claim = claim;
    result_.message = std::move(message);
    return true;
  }

  /// After a minimisation: aims lower, moves the multipliers or raises the penalty. @return whether it was the last
  bool judge(const ceres::Solver::Summary& summary) {
    if (summary.termination_type == ceres::FAILURE) return end(Claim::failed, "Ceres: " + summary.message);
    const double f = evaluator_.objective(result_.x);
    result_.claimed_objective = f;
    if (!squares_ && f - shape_.target < 0.1 * depth_) {
      // The target is reached: a lower value may be possible.
      depth_ *= 4.0;
      shape_.target = f - depth_;
      stuck_ = 0;
      return depth_ > 1e18 && end(Claim::unbounded, "objective falls without end");
    }
    // Multipliers of an unfinished minimisation would mislead: continue from the current point.
    if (summary.termination_type == ceres::NO_CONVERGENCE) return false;
    const double moved = update();
    const double scale =
        squares_ ? 1.0 : f - shape_.target;  // residual f - target scales the objective's gradient by itself
    if (violation_ <= 0.1 * options_.feasibility_tolerance && moved <= 1e-6 * (scale + largest())) {
      for (const double y : shape_.multipliers) result_.row_multipliers.push_back(y / scale);
      return end(Claim::solved, "Ceres: " + summary.message);
    }
    if (violation_ > 0.25 * last_violation_) shape_.penalty *= native_.get("penalty_growth", 5.0);
    stuck_ = violation_ > 0.99 * last_violation_ && violation_ > options_.feasibility_tolerance ? stuck_ + 1 : 0;
    if (stuck_ >= 10 && shape_.penalty > 1e6)
      return end(Claim::infeasible,
                 fmt::format("violation stays at {:.3g} whatever the penalty: locally infeasible", violation_));
    shape_.penalty = std::min(shape_.penalty, 1e12);
    last_violation_ = violation_;
    return false;
  }

  void set_bounds(ceres::Problem& problem, std::vector<double>& x) const {
    for (std::size_t i = 0; i < x.size(); ++i) {
      const nlp::Bound b = free_.bound(i);
      if (std::isfinite(b.lower)) problem.SetParameterLowerBound(x.data(), static_cast<int>(i), b.lower);
      if (std::isfinite(b.upper)) problem.SetParameterUpperBound(x.data(), static_cast<int>(i), b.upper);
    }
  }

  ceres::Solver::Options settings(StopWatch* watch) const {
    ceres::Solver::Options s;
    s.callbacks.push_back(watch);
    s.logging_type = ceres::SILENT;
    s.minimizer_progress_to_stdout = false;
    s.linear_solver_type = ceres::DENSE_QR;
    s.num_threads = 1;
    s.max_num_iterations = static_cast<int>(native_.get("max_num_iterations", 500.0));
    s.max_solver_time_in_seconds = options_.time_limit;
    // Ceres' tolerances are relative changes; at their defaults bounded problems stop far from stationary.
    s.function_tolerance = native_.get("function_tolerance", 1e-16);
    s.gradient_tolerance = native_.get("gradient_tolerance", 1e-3 * options_.tolerance);
    s.parameter_tolerance = native_.get("parameter_tolerance", 1e-5 * options_.tolerance);
    return s;
  }

  /// Updates the multipliers and returns the largest change.
  double update() {
    violation_ = 0.0;
    double moved = 0.0;
    if (rows_.empty()) return moved;
    evaluator_.rows(result_.x, rows_);
    for (std::size_t r = 0; r < rows_.size(); ++r) {
      const nlp::Bound b = evaluator_.problem().row_bound(static_cast<int>(r));
      violation_ = std::max({violation_, b.lower - rows_[r], rows_[r] - b.upper});
      const double y = shape_.penalty * shape_.shifted(b, rows_[r], r);
      moved = std::max(moved, std::abs(y - shape_.multipliers[r]));
      shape_.multipliers[r] = y;
    }
    return moved;
  }

  double largest() const {
    double y = 0.0;
    for (const double v : shape_.multipliers) y = std::max(y, std::abs(v));
    return y;
  }

  Evaluator& evaluator_;
  FreeVariables& free_;
  const NativeOptions& native_;
  const Options& options_;
  Result& result_;
  Shape shape_;
  std::vector<double> rows_;
  double violation_ = 0.0, last_violation_ = nlp::infinity;
  bool squares_ = false;  ///< the objective is a sum of squares of residuals
  double depth_ = 1.0;    ///< how far below the objective its target is set
  int stuck_ = 0;         ///< rounds that changed no violation
};

class CeresSolver final : public Solver {
 public:
  std::string name() const override { return "ceres-al"; }
  std::string library_version() const override { return "Ceres " CERES_VERSION_STRING; }
  Capabilities capabilities() const override { return {}; }
  std::string settings() const override {
    return "augmented Lagrangian around it: penalty = 10, penalty_growth = 5; linear_solver_type = DENSE_QR, "
           "max_num_iterations = 500, "
           "function_tolerance = 1e-16, gradient_tolerance = tolerance / 1000, parameter_tolerance = tolerance / 1e5";
  }

 protected:
  Result do_solve(const nlp::Problem& problem, std::span<const double> start, const Options& options) const override {
    const NativeOptions native("Ceres", options.native,
                               {"function_tolerance", "gradient_tolerance", "max_num_iterations", "outer_iterations",
                                "parameter_tolerance", "penalty", "penalty_growth"});
    Evaluator evaluator(problem, limits_of(options));
    FreeVariables free(problem, start);
    Result result;
    result.x.assign(start.begin(), start.end());
    result.message = too_large(problem, static_cast<double>(free.size()), options.time_limit);
    if (!result.message.empty()) {
      result.claim = Claim::refused;
      return result;
    }
    try {
      if (free.size() > 0) {
        Run(evaluator, free, native, options, result).go(start);
      } else {
        result.claimed_objective = evaluator.objective(start);
        result.claim = Claim::solved;
        result.message = "every variable is fixed";
      }
    } catch (const nlp::StopRun&) {
    }
    conclude(evaluator, result);
    return result;
  }

 private:
  /// A dense factorisation cannot be stopped once it has begun.
  static std::string too_large(const nlp::Problem& problem, double n, double time_limit) {
    constexpr double operations_a_second = 2e9;  // of DENSE_QR, measured
    const double rows = problem.num_rows() + std::max(1.0, static_cast<double>(problem.num_residuals())) + n;
    if (std::string why = tables_too_large(3.0 * rows * n); !why.empty()) return why;
    const double seconds = 2.0 * rows * n * n / operations_a_second;
    if (seconds <= 0.5 + 0.05 * time_limit) return "";
    return fmt::format(
        "one step, a dense factorisation of {:.0f} rows and {:.0f} variables, takes about {:.2g} s, too "
        "long for a time limit of {:.3g} s",
        rows, n, seconds, time_limit);
  }
};

}  // namespace
}  // namespace accdec::solvers

void accdec_add_solvers(accdec::solvers::SolverList& list) {
  using namespace accdec::solvers;
  list.push_back(std::make_unique<CeresSolver>());
}
