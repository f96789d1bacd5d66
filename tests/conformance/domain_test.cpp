// The same algorithms on the design problems, at orders small enough for all, against closed forms.

#include <gtest/gtest.h>

#include <accdec/corner.hpp>
#include <accdec/design/formulation.hpp>
#include <accdec/filter.hpp>
#include <accdec/nlp/derivative_check.hpp>
#include <accdec/solver.hpp>

#include "support/tasks.hpp"

namespace accdec::testing {
namespace {

using solvers::Result;
using solvers::Solver;
using solvers::Verdict;

constexpr int order = 10;  // even: the middle of the boxcar is a sample

/// One axis limit only: acceleration_max * T * (N + 1) = slack * feed. At slack 1 the boxcar is the only filter of this
/// order.
Task acceleration_task(double slack) {
  Axis axis;
  const double feed = 0.1, period = 1e-3;
  axis.acceleration_max = slack * feed / (period * (order + 1));
  Task task = plane_task(axis, plane_corner("A", 90, 0, feed, feed), 100e-6);
  task.sample_period = period;
  return task;
}

FormulationOptions formulation(const Solver& solver, int delay) {
  FormulationOptions options;
  options.order = order;
  options.blend_delays = {delay};
  options.margin = 0.0;
  options.reduced = !solver.capabilities().equality_rows;
  return options;
}

/// Local methods with first derivatives of rows that must solve every one of these; the others may say that they did
/// not.
bool must_solve(const std::string& name) {
  return name == "ipopt" || name == "ipopt-lbfgs" || name == "nlopt-slsqp";
}

class Domain : public ::testing::TestWithParam<std::string> {
 protected:
  const Solver& solver() const { return solvers::find_solver(GetParam()); }
};

// Power with no damping would reward a late tap, so there is only an acceleration limit and one fixed sample k. The
// least error at slack 1 is then that of the boxcar. At delay 0 this is v T cos(theta/2) E|i - N/2| (Eq. 24).
TEST_P(Domain, TheOnlyFeasibleFilterIsTheBoxcar) {
  const Task task = acceleration_task(1.0 + 1e-7);
  const Filter box = boxcar(order);
  const int k = measure(Blend(box, task.corners[0].geometry(), 0, task.sample_period)).corner_error_sample;
  const MarginProblem problem(task, formulation(solver(), 0), std::vector<int>{k});
  if (const std::string reason = solvers::reason_to_refuse(solver(), problem); !reason.empty()) GTEST_SKIP() << reason;
  solvers::Options options;
  options.evaluation_limit = 40'000;
  options.time_limit = 3.0;
  const Result result = solver().solve(problem, problem.start_from(box), options);
  double deviation = 0.0;
  for (int i = 0; i <= order; ++i) deviation += std::abs(i - 0.5 * order) / (order + 1);
  const double error = 0.1 * 1e-3 * std::sqrt(0.5) * deviation, sigma = std::pow(error / 100e-6, 2);
  if (result.verification.verdict == Verdict::optimal || result.verification.verdict == Verdict::feasible) {
    // The limit is 1e-7 wider than the boxcar needs, and each row may be off by 1e-8.
    EXPECT_NEAR(result.verification.objective, sigma, 1e-5 * sigma) << result.message;
  } else {
    ASSERT_FALSE(must_solve(GetParam())) << result.message;
    GTEST_SKIP() << "reported as " << to_string(result.verification.verdict) << ": " << result.message;
  }
}

// With room for other filters the problem is convex: every verified optimum is the same.
TEST_P(Domain, ConvexMarginHasOneOptimum) {
  const Task task = acceleration_task(1.5);
  const Filter start = boxcar(order);
  const MarginProblem problem(task, formulation(solver(), 2), std::vector<int>{5});
  if (const std::string reason = solvers::reason_to_refuse(solver(), problem); !reason.empty()) GTEST_SKIP() << reason;
  const MarginProblem reference_problem(task, formulation(solvers::find_solver("ipopt"), 2), std::vector<int>{5});
  const Result reference = solvers::find_solver("ipopt").solve(reference_problem, reference_problem.start_from(start));
  ASSERT_EQ(reference.verification.verdict, Verdict::optimal);
  solvers::Options options;
  options.evaluation_limit = 40'000;
  options.time_limit = 3.0;
  const Result result = solver().solve(problem, problem.start_from(start), options);
  if (must_solve(GetParam())) {
    ASSERT_EQ(result.verification.verdict, Verdict::optimal) << result.message;
  }
  // No feasible point lies below a convex problem's minimum; a verified optimum does not lie above it either.
  if (result.verification.verdict == Verdict::infeasible) GTEST_SKIP() << "reported as infeasible: " << result.message;
  EXPECT_GT(result.verification.objective, reference.verification.objective - 1e-5);
  if (result.verification.verdict == Verdict::optimal) {
    EXPECT_NEAR(result.verification.objective, reference.verification.objective, 1e-4) << result.message;
  } else {
    GTEST_SKIP() << "reported as " << to_string(result.verification.verdict) << " at " << result.verification.objective
                 << " for " << reference.verification.objective << ": " << result.message;
  }
}

// Half a sample past k, the path of the smooth problem lies on the sampled one. With the boxcar as the only filter,
// bisection on the spline's own error gives the least delay.
TEST_P(Domain, LeastDelayOfTheBoxcar) {
  Task task = acceleration_task(1.0 + 1e-7);
  task.corners[0].error_max = 40e-6;
  const DelayProblem problem(task, formulation(solver(), 0));
  if (const std::string reason = solvers::reason_to_refuse(solver(), problem); !reason.empty()) GTEST_SKIP() << reason;
  solvers::Options options;
  options.evaluation_limit = 40'000;
  options.time_limit = 3.0;
  const Result result = solver().solve(problem, problem.start_from(boxcar(order), std::vector<double>{5.0}), options);
  // Linear Acc/Dec in continuous time, Eq. (12): error = v tau / 4 cos(theta/2) (1 - d T / tau)^2 with tau = (N + 1) T.
  const double tau = (order + 1) * 1e-3, none = 0.1 * tau / 4.0 * std::sqrt(0.5);
  const double delay = (1.0 - std::sqrt(40e-6 / none)) * (order + 1);
  if (must_solve(GetParam())) {
    ASSERT_EQ(result.verification.verdict, Verdict::optimal) << result.message;
  }
  if (result.verification.verdict == Verdict::optimal) {
    EXPECT_NEAR(problem.delays(result.x)[0], delay, 1e-3) << result.message;
  } else {
    GTEST_SKIP() << "reported as " << to_string(result.verification.verdict)
                 << " at d = " << problem.delays(result.x)[0] << " for " << delay << ": " << result.message;
  }
}

std::vector<std::string> names() {
  std::vector<std::string> all;
  for (const auto& solver : solvers::registry()) all.push_back(solver->name());
  return all;
}

INSTANTIATE_TEST_SUITE_P(All, Domain, ::testing::ValuesIn(names()), [](const auto& info) {
  std::string name = info.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

}  // namespace
}  // namespace accdec::testing
