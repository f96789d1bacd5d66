#include <gmock/gmock.h>

#include <accdec/corner.hpp>
#include <accdec/design/formulation.hpp>
#include <accdec/machine.hpp>
#include <accdec/task/contradictions.hpp>
#include <accdec/task/simulation.hpp>
#include <accdec/verify.hpp>

#include "support/tasks.hpp"

namespace accdec {
namespace {

using testing::random_filter;
using testing::random_task;

/// Largest row violation, relative to the rows' scale of 1.
double violation(const nlp::Problem& problem, const std::vector<double>& x) {
  std::vector<double> c(static_cast<std::size_t>(problem.num_rows()));
  problem.rows(x, c);
  double worst = 0.0;
  for (int r = 0; r < problem.num_rows(); ++r) {
    const nlp::Bound b = problem.row_bound(r);
    const double value = c[static_cast<std::size_t>(r)];
    worst = std::max({worst, b.lower - value, value - b.upper});
  }
  return worst;
}

FormulationOptions options_for(const Task& task, int order, std::vector<int> delays, bool reduced) {
  FormulationOptions o;
  o.order = order;
  o.blend_delays = std::move(delays);
  o.mode_frequencies = initial_frequencies(task, order);
  o.margin = 0.0;
  o.reduced = reduced;
  return o;
}

TEST(MarginProblem, RowsHoldExactlyWhenTheUtilisationsDo) {
  std::mt19937 rng(11);
  int held = 0, broken = 0;
  for (int round = 0; round < 3000; ++round) {
    Task task = random_task(rng, 1 + round % 2);
    if (round % 3 == 0) task.machine.modes = {{50.0, 50.0, 0.4}};
    if (!contradictions(task).empty()) continue;
    const int order = 5 + static_cast<int>(rng() % 60);
    // Smooth random filters, so that a fair share holds everything.
    std::vector<double> taps;
    const double skew = std::uniform_real_distribution<double>(0.0, 0.8)(rng);
    for (int i = 0; i <= order; ++i) taps.push_back((std::min(i, order - i) + 1.0) * (1.0 + skew * i / order));
    const Filter filter{taps};
    std::vector<int> delays, samples;
    for (std::size_t j = 0; j < task.corners.size(); ++j) {
      delays.push_back(static_cast<int>(rng() % static_cast<unsigned>(order + 2)));
      samples.push_back(0);
    }
    double worst = 0.0;
    for (std::size_t j = 0; j < task.corners.size(); ++j) {
      const Blend blend(filter, task.corners[j].geometry(), delays[j], task.sample_period);
      const CornerMeasures m = measure(blend);
      samples[j] = m.corner_error_sample;
      for (const LimitUse& use :
           axis_utilisation(filter, task.corners[j].geometry(), delays[j], task.sample_period, task.machine)) {
        worst = std::max(worst, use.utilisation);
      }
      if (task.corners[j].speed_min > 0.0)
        worst = std::max(worst, utilisation_of(LimitKind::speed_min, m.speed_min, task.corners[j].speed_min));
    }
    for (const LimitUse& use : vibration_utilisation(filter, task.sample_period, task.machine))
      worst = std::max(worst, use.utilisation);
    if (std::abs(worst - 1.0) < 1e-6) continue;
    for (const bool reduced : {false, true}) {
      const MarginProblem problem(task, options_for(task, order, delays, reduced), samples);
      const std::vector<double> x = problem.start_from(filter);
      const double v = violation(problem, x);
      EXPECT_EQ(worst < 1.0, v < 1e-9) << "round " << round << " worst use " << worst << " violation " << v;
    }
    ++(worst < 1.0 ? held : broken);
  }
  EXPECT_GT(held, 200);
  EXPECT_GT(broken, 200);
}

/// Smoothing, a servo of all axes, servos that differ, or an undershoot of one axis.
void give_response(Task& task, int kind) {
  if (kind == 0) task.machine.prefilter_taps = {0.2, 0.5, 0.3};
  for (Axis& axis : task.machine.axes) axis.servo_gain = kind > 0 ? 300.0 : unlimited, axis.velocity_feedforward = 0.4;
  if (kind == 2) task.machine.axes[1].servo_gain = 150.0;
  if (kind == 3) {
    task.machine.axes[0].servo_gain = unlimited, task.machine.axes[0].velocity_feedforward = 0.0;
    task.machine.axes[0].response_taps = {0.4, 0.9, -0.2, -0.1};
  }
}

/// Behind a response, too: all uses are the simulation's, which convolves and knows no formula of the rows.
TEST(MarginProblem, RowsBehindAResponseHoldExactlyWhenTheSimulationDoes) {
  std::mt19937 rng(29);
  int held = 0, broken = 0;
  for (int round = 0; round < 600; ++round) {
    Task task = random_task(rng, 1);
    task.sample_period = 5e-3;
    give_response(task, round % 4);
    if (round % 3 == 0) task.machine.modes = {{40.0, 40.0, 1.0, 0.05, 0.05, 0, 60e-6}};
    if (!contradictions(task).empty()) continue;
    const int order = 5 + static_cast<int>(rng() % 40), delay = static_cast<int>(rng() % static_cast<unsigned>(order));
    std::vector<double> taps;
    for (int i = 0; i <= order; ++i) taps.push_back(std::min(i, order - i) + 1.0);
    const Filter filter{taps};
    std::vector<LimitUse> uses;
    verify_by_simulation(task, filter, {delay}, &uses);
    double worst = 0.0, error = 0.0;
    int nearest = 0;
    for (const LimitUse& use : uses) {
      (use.kind == LimitKind::corner_error ? error : worst) =
          std::max(use.utilisation, use.kind == LimitKind::corner_error ? 1.0 : worst);
      if (use.kind == LimitKind::corner_error) nearest = static_cast<int>(use.sample);
    }
    if (std::abs(worst - 1.0) < 1e-6) continue;
    for (const bool reduced : {false, true}) {
      FormulationOptions options = options_for(task, order, {delay}, reduced);
      options.mode_blends = true;
      const MarginProblem problem(task, options, std::vector<int>{nearest});
      const std::vector<double> x = problem.start_from(filter);
      const double v = violation(problem, x);
      EXPECT_EQ(worst < 1.0, v < 1e-9) << "round " << round << " worst use " << worst << " violation " << v;
      EXPECT_NEAR(std::sqrt(x[static_cast<std::size_t>(problem.sigma())]), error, 1e-9 * error) << "round " << round;
    }
    ++(worst < 1.0 ? held : broken);
  }
  EXPECT_GT(held, 50);
  EXPECT_GT(broken, 50);
}

TEST(MarginProblem, SigmaIsTheSquaredErrorUse) {
  std::mt19937 rng(3);
  for (int round = 0; round < 50; ++round) {
    Task task = random_task(rng, 1);
    task.corners[0].error_max = 1e-6;
    const Filter filter = random_filter(rng, 20);
    const CornerMeasures m = measure(Blend(filter, task.corners[0].geometry(), 4, task.sample_period));
    const MarginProblem problem(task, options_for(task, 20, {4}, false), std::vector<int>{m.corner_error_sample});
    const double sigma = problem.start_from(filter)[static_cast<std::size_t>(problem.sigma())];
    EXPECT_NEAR(std::sqrt(sigma) * 1e-6, std::max(1e-6, m.corner_error), 1e-9 * m.corner_error);
  }
}

TEST(DelayProblem, PathAtIntegerInstantsIsHalfWayBetweenSamples) {
  // The quadratic B-spline of the sampled path touches its edges in their midpoints.
  std::mt19937 rng(5);
  for (int round = 0; round < 50; ++round) {
    const Task task = random_task(rng, 1);
    const TaskCorner& corner = task.corners[0];
    const int order = 3 + static_cast<int>(rng() % 30), delay = static_cast<int>(rng() % 10);
    const Filter filter = random_filter(rng, order);
    const DelayProblem problem(task, options_for(task, order, {delay}, false));
    const std::vector<double> delays{static_cast<double>(delay)};
    std::vector<double> x = problem.start_from(filter, delays);
    const Blend blend(filter, corner.geometry(), delay, task.sample_period);
    const auto n = static_cast<std::size_t>(order);
    for (int k = 1; k <= order + delay + 1; ++k) {
      x[n + 1] = k;  // variables: B, then d, t, P, Q of the corner
      x[n + 2] = x[n + 3] = 0.0;
      std::vector<double> c(static_cast<std::size_t>(problem.num_rows()));
      problem.rows(x, c);
      const double unit = *corner.error_max;
      EXPECT_NEAR(c[0] * unit, 0.5 * (blend.distance_in(k) + blend.distance_in(k - 1)), 1e-13);
      EXPECT_NEAR(c[1] * unit, 0.5 * (blend.distance_out(k) + blend.distance_out(k - 1)), 1e-13);
    }
  }
}

/// Central differences of rows, and of the Lagrangian gradient, against the analytic derivatives.
void check_derivatives(const nlp::Problem& problem, const std::vector<double>& x) {
  const auto n = static_cast<std::size_t>(problem.num_variables()), m = static_cast<std::size_t>(problem.num_rows());
  std::vector<double> multipliers(m);
  for (std::size_t r = 0; r < m; ++r) multipliers[r] = std::sin(1.0 + static_cast<double>(r));
  const auto dense_jacobian = [&](const std::vector<double>& at) {
    std::vector<double> values(problem.jacobian_pattern().size());
    problem.jacobian(at, values);
    Eigen::MatrixXd j = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(m), static_cast<Eigen::Index>(n));
    for (std::size_t e = 0; e < values.size(); ++e) {
      j(problem.jacobian_pattern()[e].row, problem.jacobian_pattern()[e].column) += values[e];
    }
    return j;
  };
  const auto rows = [&](const std::vector<double>& at) {
    Eigen::VectorXd c(static_cast<Eigen::Index>(m));
    problem.rows(at, {c.data(), m});
    return c;
  };
  const Eigen::Map<const Eigen::VectorXd> y(multipliers.data(), static_cast<Eigen::Index>(m));
  const Eigen::MatrixXd jacobian = dense_jacobian(x);
  Eigen::MatrixXd hessian = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(n));
  if (problem.has_hessian()) {
    std::vector<double> values(problem.hessian_pattern().size());
    problem.hessian(x, 1.0, multipliers, values);
    for (std::size_t e = 0; e < values.size(); ++e) {
      const auto [i, j] = problem.hessian_pattern()[e];
      hessian(i, j) += values[e];
      if (i != j) hessian(j, i) += values[e];
    }
  }
  for (std::size_t i = 0; i < n; ++i) {
    const double h = 1e-6 * std::max(1.0, std::abs(x[i]));
    std::vector<double> up = x, down = x;
    up[i] += h;
    down[i] -= h;
    const auto column = static_cast<Eigen::Index>(i);
    const Eigen::VectorXd difference = (rows(up) - rows(down)) / (2.0 * h);
    for (Eigen::Index r = 0; r < difference.size(); ++r) {
      EXPECT_NEAR(difference[r], jacobian(r, column),
                  1e-6 * (1.0 + std::abs(jacobian(r, column)) + rows(x).cwiseAbs().maxCoeff()))
          << problem.row_name(static_cast<int>(r)) << " by " << problem.variable_name(static_cast<int>(i));
    }
    if (!problem.has_hessian()) continue;
    const Eigen::VectorXd slope = (dense_jacobian(up) - dense_jacobian(down)).transpose().lazyProduct(y) / (2.0 * h);
    for (Eigen::Index r = 0; r < slope.size(); ++r) {
      EXPECT_NEAR(slope[r], hessian(r, column), 1e-5 * (1.0 + hessian.cwiseAbs().maxCoeff()))
          << problem.variable_name(static_cast<int>(r)) << ", " << problem.variable_name(static_cast<int>(i));
    }
  }
}

TEST(Formulations, DerivativesAgreeWithDifferences) {
  std::mt19937 rng(17);
  for (int round = 0; round < 12; ++round) {
    Task task = random_task(rng, 2);
    task.machine.modes = {{40.0, 50.0, 0.1}};
    task.design.symmetric = round % 4 == 0;
    if (round >= 4) task.sample_period = 5e-3, give_response(task, round % 4);
    const int order = 2 + static_cast<int>(rng() % 12);
    const Filter filter = random_filter(rng, order);
    const std::vector<double> delays{0.31 + static_cast<double>(rng() % 5), 2.77};
    for (const bool reduced : {false, true}) {
      const DelayProblem delay_problem(task, options_for(task, order, {2, 3}, reduced));
      std::vector<double> x = delay_problem.start_from(filter, delays);
      // Away from the knots of the interpolation, where second derivatives jump.
      const std::vector<double> t = delay_problem.instants(x);
      for (const double instant : t) {
        for (double& v : x) {
          if (v == instant) v = std::floor(v) + 0.4567;
        }
      }
      check_derivatives(delay_problem, x);
      const MarginProblem margin_problem(task, options_for(task, order, {2, 3}, reduced),
                                         std::vector<int>{order / 2, order / 2 + 1});
      check_derivatives(margin_problem, margin_problem.start_from(filter));
    }
  }
}

TEST(Formulations, GrowLinearlyWithTheOrder) {
  std::mt19937 rng(2);
  Task task = random_task(rng, 1);
  for (Axis& axis : task.machine.axes) {
    axis.acceleration_max = 10.0;
    axis.jerk_max = 1e4;
    axis.force_max = axis.power_max = axis.regeneration_max = 1e4;
  }
  const auto entries = [&](int order) {
    const DelayProblem problem(task, options_for(task, order, {5}, false));
    return static_cast<double>(problem.jacobian_pattern().size() + problem.hessian_pattern().size());
  };
  EXPECT_NEAR(entries(2000) / entries(1000), 2.0, 0.02);
}

TEST(Contradictions, BandsAcrossTheSampleRate) {
  Task task = testing::plane_task({}, testing::plane_corner("A", 90, 0, 0.1, 0.1), 1e-4);
  task.machine.modes = {{38.0, 999.0, 0.1}};
  EXPECT_TRUE(contradictions(task).empty());
  task.machine.modes = {{38.0, 1000.0, 0.1}};
  ASSERT_EQ(contradictions(task).size(), 1U);
  EXPECT_THAT(contradictions(task)[0], ::testing::HasSubstr("contains 1000 Hz, a multiple of the sample rate"));
}

TEST(Contradictions, NameTheLimit) {
  Axis axis;
  axis.damping = 1000.0;
  axis.force_max = 50.0;
  const Task task = testing::plane_task(axis, testing::plane_corner("A", 90, 0, 0.1, 0.1), 1e-4);
  ASSERT_EQ(contradictions(task).size(), 2U);
  EXPECT_THAT(contradictions(task)[0],
              ::testing::HasSubstr("force x: corner A needs 100 N at constant feed, the limit is 50 N"));
}

}  // namespace
}  // namespace accdec
