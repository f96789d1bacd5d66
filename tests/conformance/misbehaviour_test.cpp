// Misbehaviour of the libraries when called directly, and the result through the interface instead.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <limits>
#include <thread>

#include <nlopt.h>
#include <sys/wait.h>
#include <unistd.h>

#include <ceres/ceres.h>
#include <conformance/cases.hpp>
#include <gtest/gtest.h>

#include <accdec/design/formulation.hpp>
#include <accdec/filter.hpp>
#include <accdec/solver.hpp>
#include <accdec/task.hpp>

#include "support/paths.hpp"

namespace accdec::testing {
namespace {

using nlp::infinity;
using solvers::Claim;
using solvers::find_solver;
using solvers::Result;
using solvers::Verdict;

const Case& case_named(const std::string& name) {
  for (const Case& c : cases()) {
    if (c.problem.name() == name) return c;
  }
  throw std::out_of_range(name);
}

// minimise -x - y subject to x + 2 y <= 3, 2 x + y = 4, x >= 0, y >= 2: the last three leave x <= 1 and x + 2 y >= 5.
double minus_sum(unsigned, const double* x, double* g, void*) {
  if (g != nullptr) g[0] = g[1] = -1.0;
  return -x[0] - x[1];
}
double first_row(unsigned, const double* x, double* g, void*) {
  if (g != nullptr) g[0] = 1.0, g[1] = 2.0;
  return x[0] + 2.0 * x[1] - 3.0;
}
double second_row(unsigned, const double* x, double* g, void*) {
  if (g != nullptr) g[0] = 2.0, g[1] = 1.0;
  return 2.0 * x[0] + x[1] - 4.0;
}
FormulaProblem infeasible() {
  return {"infeasible",
          {{0.0, infinity}, {2.0, infinity}},
          [](const Variables& x) { return -1.0 * (x[0] + x[1]); },
          {{{-infinity, 3.0}, [](const Variables& x) { return x[0] + 2.0 * x[1]; }},
           {{4.0, 4.0}, [](const Variables& x) { return 2.0 * x[0] + x[1]; }}}};
}

TEST(NloptMisbehaviour, ReportsSuccessAtInfeasiblePoints) {
  for (const auto& [method, name] :
       {std::pair{NLOPT_LD_SLSQP, "nlopt-slsqp"}, std::pair{NLOPT_LN_COBYLA, "nlopt-cobyla"}}) {
    nlopt_opt opt = nlopt_create(method, 2);
    const double lower[] = {0.0, 2.0};
    nlopt_set_lower_bounds(opt, lower);
    nlopt_set_min_objective(opt, minus_sum, nullptr);
    nlopt_add_inequality_constraint(opt, first_row, nullptr, 1e-8);
    nlopt_add_equality_constraint(opt, second_row, nullptr, 1e-8);
    nlopt_set_xtol_rel(opt, 1e-8);
    nlopt_set_maxeval(opt, 5000);
    double x[] = {1.0, 2.0}, f = 0.0;
    EXPECT_GT(nlopt_optimize(opt, x, &f), 0) << name;
    EXPECT_GT(std::max(x[0] + 2.0 * x[1] - 3.0, std::abs(2.0 * x[0] + x[1] - 4.0)), 0.4) << name;
    nlopt_destroy(opt);
    EXPECT_EQ(find_solver(name).solve(infeasible(), std::vector<double>{1.0, 2.0}).verification.verdict,
              Verdict::infeasible);
  }
}

double disc(unsigned, const double* x, double* g, void*) {
  if (g != nullptr) g[0] = 2.0 * x[0], g[1] = 2.0 * x[1];
  return x[0] * x[0] + x[1] * x[1] - 1.0;
}
double beyond_disc(unsigned, const double* x, double* g, void*) {
  if (g != nullptr) g[0] = g[1] = -1.0;
  return 3.0 - x[0] - x[1];
}

// minimise -x - y in the unit disc and beyond the line x + y = 3, which passes it at 3/sqrt(2) - 1 = 1.12.
TEST(NloptMisbehaviour, MmaReportsSuccessAtInfeasiblePoints) {
  nlopt_opt opt = nlopt_create(NLOPT_LD_MMA, 2);
  nlopt_set_min_objective(opt, minus_sum, nullptr);
  nlopt_add_inequality_constraint(opt, disc, nullptr, 1e-8);
  nlopt_add_inequality_constraint(opt, beyond_disc, nullptr, 1e-8);
  nlopt_set_xtol_rel(opt, 1e-8);
  nlopt_set_maxeval(opt, 5000);
  double x[] = {1.0, 1.0}, f = 0.0;
  const nlopt_result claim = nlopt_optimize(opt, x, &f);
  nlopt_destroy(opt);
  EXPECT_TRUE(claim == NLOPT_XTOL_REACHED || claim == NLOPT_FTOL_REACHED) << claim;
  EXPECT_GT(std::max(disc(2, x, nullptr, nullptr), beyond_disc(2, x, nullptr, nullptr)), 0.5);
  const FormulaProblem problem("disc and line", {{}, {}}, [](const Variables& v) { return -1.0 * (v[0] + v[1]); },
                               {{{-infinity, 1.0}, [](const Variables& v) { return sqr(v[0]) + sqr(v[1]); }},
                                {{3.0, infinity}, [](const Variables& v) { return v[0] + v[1]; }}});
  EXPECT_EQ(find_solver("nlopt-mma").solve(problem, std::vector<double>{1.0, 1.0}).verification.verdict,
            Verdict::infeasible);
}

double hs022_objective(unsigned, const double* x, double* g, void*) {
  if (g != nullptr) g[0] = 2.0 * (x[0] - 2.0), g[1] = 2.0 * (x[1] - 1.0);
  return std::pow(x[0] - 2.0, 2) + std::pow(x[1] - 1.0, 2);
}
double hs022_first(unsigned, const double* x, double* g, void*) {
  if (g != nullptr) g[0] = g[1] = 1.0;
  return x[0] + x[1] - 2.0;
}
double hs022_second(unsigned, const double* x, double* g, void*) {
  if (g != nullptr) g[0] = 2.0 * x[0], g[1] = -1.0;
  return x[0] * x[0] - x[1];
}

TEST(NloptMisbehaviour, MmaReportsSuccessWhereNothingIsStationary) {
  nlopt_opt opt = nlopt_create(NLOPT_LD_MMA, 2);
  nlopt_set_min_objective(opt, hs022_objective, nullptr);
  nlopt_add_inequality_constraint(opt, hs022_first, nullptr, 1e-8);
  nlopt_add_inequality_constraint(opt, hs022_second, nullptr, 1e-8);
  nlopt_set_xtol_rel(opt, 1e-8);
  double x[] = {2.0, 2.0}, f = 0.0;
  EXPECT_EQ(nlopt_optimize(opt, x, &f), NLOPT_XTOL_REACHED);
  EXPECT_GT(f, 2.0);  // the minimum is 1
  // Nor does it take equality rows at all.
  EXPECT_EQ(nlopt_add_equality_constraint(opt, hs022_first, nullptr, 1e-8), NLOPT_INVALID_ARGS);
  nlopt_destroy(opt);
  const Case& c = case_named("HS022");
  const Result result = find_solver("nlopt-mma").solve(c.problem, c.start);
  EXPECT_EQ(result.claim, Claim::solved);
  EXPECT_EQ(result.verification.verdict, Verdict::feasible);
  EXPECT_EQ(find_solver("nlopt-mma").solve(infeasible(), std::vector<double>{1.0, 2.0}).claim, Claim::refused);
}

TEST(NloptMisbehaviour, AFailureCodeAtTheOptimumIsAVerifiedSuccess) {
  // The augmented Lagrangian ends HS015 with NLOPT_FAILURE, SLSQP a rank-deficient start with ROUNDOFF_LIMITED.
  const Case& c = case_named("HS015");
  const Result result = find_solver("nlopt-auglag-lbfgs").solve(c.problem, c.start);
  EXPECT_EQ(result.claim, Claim::failed);
  EXPECT_EQ(result.verification.verdict, Verdict::optimal);
  EXPECT_NEAR(result.verification.objective, c.optimum, 1e-5 * c.optimum);
}

TEST(NloptMisbehaviour, CobylaNeverReturnsFromNotANumber) {
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    nlopt_opt opt = nlopt_create(NLOPT_LN_COBYLA, 2);
    nlopt_set_min_objective(
        opt, [](unsigned, const double*, double*, void*) { return std::numeric_limits<double>::quiet_NaN(); }, nullptr);
    nlopt_set_maxeval(opt, 100);
    nlopt_set_maxtime(opt, 0.1);
    double x[] = {1.0, 1.0}, f = 0.0;
    nlopt_optimize(opt, x, &f);
    _exit(0);
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(1500));
  EXPECT_EQ(waitpid(child, nullptr, WNOHANG), 0) << "it returned";
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);

  const FormulaProblem nan("nan", {{}, {}},
                           [](const Variables& x) { return std::numeric_limits<double>::quiet_NaN() * x[0]; }, {});
  EXPECT_EQ(find_solver("nlopt-cobyla").solve(nan, std::vector<double>{1.0, 1.0}).claim, Claim::invalid_number);
}

/// The delay problem of a flat corner at N = 33: with rounding COBYLA's inner loop comes round to where it was.
DelayProblem flat_corner(const Task& task) {
  FormulationOptions options;
  options.order = 33;
  options.blend_delays = {1};
  return {task, options};
}

/// NLopt's COBYLA on a problem as our wrapper would call it, for half a second by its own clock.
void run_cobyla(const DelayProblem& problem, const std::vector<double>& start) {
  const auto n = static_cast<unsigned>(problem.num_variables());
  nlopt_opt opt = nlopt_create(NLOPT_LN_COBYLA, n);
  std::vector<double> lower, upper;
  for (int i = 0; i < problem.num_variables(); ++i) {
    lower.push_back(problem.variable_bound(i).lower), upper.push_back(problem.variable_bound(i).upper);
  }
  nlopt_set_lower_bounds(opt, lower.data()), nlopt_set_upper_bounds(opt, upper.data());
  nlopt_set_min_objective(
      opt,
      [](unsigned size, const double* x, double*, void* p) {
        return static_cast<DelayProblem*>(p)->objective({x, size});
      },
      const_cast<DelayProblem*>(&problem));
  // Upper sides as row - upper <= 0, then lower ones as lower - row <= 0; equalities apart.
  const auto sides = [](bool equality, double* out, unsigned size, const double* x, void* p) {
    const auto& rows = *static_cast<DelayProblem*>(p);
    std::vector<double> c(static_cast<std::size_t>(rows.num_rows()));
    rows.rows({x, size}, c);
    unsigned count = 0;
    for (int r = 0; r < rows.num_rows(); ++r) {
      const nlp::Bound b = rows.row_bound(r);
      const double value = c[static_cast<std::size_t>(r)];
      if (equality != (b.lower == b.upper)) continue;
      if (std::isfinite(b.upper)) out[count++] = value - b.upper;
      if (!equality && std::isfinite(b.lower)) out[count++] = b.lower - value;
    }
    return count;
  };
  static const auto evaluate = sides;  // NLopt takes plain functions
  auto* const data = const_cast<DelayProblem*>(&problem);
  std::vector<double> scratch(2 * static_cast<std::size_t>(problem.num_rows()));
  const std::vector<double> tolerances(scratch.size(), 1e-9);
  nlopt_add_inequality_mconstraint(
      opt, sides(false, scratch.data(), n, start.data(), data),
      [](unsigned, double* out, unsigned size, const double* x, double*, void* p) { evaluate(false, out, size, x, p); },
      data, tolerances.data());
  nlopt_add_equality_mconstraint(
      opt, sides(true, scratch.data(), n, start.data(), data),
      [](unsigned, double* out, unsigned size, const double* x, double*, void* p) { evaluate(true, out, size, x, p); },
      data, tolerances.data());
  nlopt_set_xtol_rel(opt, 1e-8);
  nlopt_set_ftol_rel(opt, 1e-14);
  nlopt_set_maxtime(opt, 0.5);
  std::vector<double> x = start;
  double f = 0.0;
  nlopt_optimize(opt, x.data(), &f);
}

TEST(NloptMisbehaviour, CobylaLoopsWithoutEvaluating) {
  const Task task = read_task(accdec::test_support::source_folder() + "/problems/corner/flat-angle.toml");
  const DelayProblem problem = flat_corner(task);
  const std::vector<double> start = problem.start_from(trapezoid(33, 11), std::vector<double>{1.0});
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    run_cobyla(problem, start);
    _exit(0);
  }
  std::this_thread::sleep_for(std::chrono::seconds(4));
  EXPECT_EQ(waitpid(child, nullptr, WNOHANG), 0) << "it returned";
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);

  solvers::Options options;
  options.time_limit = 0.5;
  const Result result = find_solver("nlopt-cobyla").solve(problem, start, options);
  EXPECT_EQ(result.claim, Claim::time_limit);
  EXPECT_NE(result.message.find("had to be ended"), std::string::npos) << result.message;
  EXPECT_EQ(result.x.size(), start.size());
}

TEST(NloptMisbehaviour, RandomSearchesDifferFromRunToRun) {
  const auto run = [] {
    nlopt_opt opt = nlopt_create(NLOPT_GN_CRS2_LM, 2);
    nlopt_set_lower_bounds1(opt, -3.0);
    nlopt_set_upper_bounds1(opt, 3.0);
    nlopt_set_min_objective(opt, hs022_objective, nullptr);
    nlopt_set_maxeval(opt, 200);
    std::pair<double, double> end;
    double x[] = {2.0, 2.0}, f = 0.0;
    nlopt_optimize(opt, x, &f);
    nlopt_destroy(opt);
    return std::pair{x[0], x[1]};
  };
  EXPECT_NE(run(), run());
  const Case& c = case_named("HS022 in a box");
  const auto& crs = find_solver("nlopt-crs2");
  solvers::Options other;
  other.seed = 2;
  EXPECT_EQ(crs.solve(c.problem, c.start).x, crs.solve(c.problem, c.start).x);
  EXPECT_NE(crs.solve(c.problem, c.start).x, crs.solve(c.problem, c.start, other).x);
}

class Rosenbrock final : public ceres::SizedCostFunction<2, 2> {
 public:
  bool Evaluate(double const* const* p, double* r, double** j) const override {
    const double *x = p[0], ten = 10.0 * std::sqrt(2.0);
    r[0] = ten * (x[1] - x[0] * x[0]), r[1] = std::sqrt(2.0) * (1.0 - x[0]);
    if (j != nullptr && j[0] != nullptr)
      j[0][0] = -2.0 * ten * x[0], j[0][1] = ten, j[0][2] = -std::sqrt(2.0), j[0][3] = 0.0;
    return true;
  }
};

TEST(CeresMisbehaviour, ConvergesBesideTheMinimumAlongABound) {
  ceres::Problem problem;
  double x[] = {-2.0, 1.5};
  problem.AddResidualBlock(new Rosenbrock, nullptr, x);
  problem.SetParameterLowerBound(x, 1, 1.5);
  ceres::Solver::Options options;
  options.logging_type = ceres::SILENT;
  options.max_num_iterations = 500;
  options.function_tolerance = 1e-16;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  EXPECT_EQ(summary.termination_type, ceres::CONVERGENCE);
  EXPECT_GT(summary.final_cost, 0.0504262 + 1e-5);
  const Case& c = case_named("HS002");
  EXPECT_NE(find_solver("ceres-al").solve(c.problem, c.start).verification.verdict, Verdict::optimal);
}

}  // namespace
}  // namespace accdec::testing
