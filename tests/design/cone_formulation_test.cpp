#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

#include <accdec/design/cone_formulation.hpp>
#include <accdec/exact/exact.hpp>
#include <accdec/nlp/derivative_check.hpp>
#include <accdec/solver.hpp>
#include <accdec/verify.hpp>

#include "support/tasks.hpp"

namespace accdec {
namespace {

/// Two corners, two unequal axes with friction, and a band.
Task two_cones() {
  Axis axis;
  axis.acceleration_max = 7.0;
  axis.jerk_max = 900.0;
  axis.mass = 30.0;
  axis.damping = 200.0;
  axis.force_max = 260.0;
  Task task = testing::plane_task(axis, testing::plane_corner("A", 70, 20, 0.1, 0.08), 60e-6);
  task.machine.axes[1].jerk_max = 700.0;
  task.corners.push_back(testing::plane_task(axis, testing::plane_corner("B", 110, 50, 0.06, 0.1), 40e-6).corners[0]);
  task.machine.modes = {{30.0, 36.0, 0.2}};
  return task;
}

std::vector<double> random_taps(int order, std::mt19937& random) {
  std::vector<double> taps;
  double sum = 0.0;
  for (int i = 0; i <= order; ++i) {
    taps.push_back(std::uniform_real_distribution<double>(0.0, 1.0)(random));
    sum += taps.back();
  }
  for (double& b : taps) b /= sum;
  return taps;
}

/// The part of each cone as t - |u|.
std::vector<double> room_in_cones(const nlp::ConeProblem& problem, const std::vector<double>& slacks) {
  std::vector<double> rooms;
  auto at = slacks.begin() + problem.data().linear;
  for (const int n : problem.data().cones) {
    double square = 0.0;
    for (int i = 1; i < n; ++i) square += at[i] * at[i];
    rooms.push_back(*at - std::sqrt(square));
    at += n;
  }
  return rooms;
}

// Each row and cone is what simulation finds of the limit.
TEST(ConeFormulation, SlacksAreWhatSimulationLeaves) {
  const Task task = two_cones();
  std::mt19937 random(3);
  for (const int order : {8, 25}) {
    const std::vector<double> taps = random_taps(order, random);
    const std::vector<int> delays{order / 2, order / 3};
    std::vector<LimitUse> uses;
    std::vector<CornerResult> corners;
    verify_by_simulation(task, Filter(taps), delays, &uses, &corners);
    std::vector<double> x = taps;
    x.push_back(0.0);
    std::vector<double> most(2, -1e9);
    double least_linear = 0.0, vibration = 0.0;
    for (int k = 0; k <= order + delays[0] + 1; ++k) {
      const nlp::ConeProblem problem = cone_problem(task, order, {{delays[0], k}, {delays[1], k}});
      const std::vector<double> slacks = problem.slacks(x), rooms = room_in_cones(problem, slacks);
      for (std::size_t j = 0; j < 2; ++j) most[j] = std::max(most[j], rooms[j]);
      least_linear = *std::min_element(slacks.begin(), slacks.begin() + problem.data().linear);
      vibration = *std::min_element(rooms.begin() + 2, rooms.end());
    }
    double used = 1.0;  // taps that are nothing
    for (const LimitUse& use : uses) {
      if (use.kind == LimitKind::vibration) {
        EXPECT_NEAR(use.bound - use.value, vibration, 1e-2);
      } else if (use.kind != LimitKind::corner_error) {
        used = std::max(used, use.utilisation);
      }
    }
    EXPECT_NEAR(1.0 - least_linear, used, 1e-9);
    for (std::size_t j = 0; j < 2; ++j) {
      const double unit =
          task.sample_period * std::max(task.corners[j].geometry().feed_in, task.corners[j].geometry().feed_out);
      EXPECT_NEAR(most[j] * unit, *task.corners[j].error_max - corners[j].corner_error, 1e-12);
    }
  }
}

TEST(ConeFormulation, DerivativesAgree) {
  std::mt19937 random(4);
  std::vector<double> x = random_taps(12, random);
  x.push_back(0.7);
  const nlp::ConeProblem problem = cone_problem(two_cones(), 12, {{5, 9}, {6, 9}});
  for (const auto& wrong : nlp::check_derivatives(problem, x)) ADD_FAILURE() << wrong.text;
}

// By a local solver, which finds the optimum of a convex problem: no excess at the shortest design's place, some
// wherever the corner would be a sample shorter.
TEST(ConeFormulation, AgreesWithTheExactMethod) {
  Axis axis;
  axis.acceleration_max = 9.0;
  axis.jerk_max = 3000.0;
  const Task task = testing::plane_task(axis, testing::plane_corner("A", 100, 0, 0.1, 0.1), 50e-6);
  const DesignResult shortest = design_exact(task);
  ASSERT_EQ(shortest.status, Status::optimal);
  const solvers::Solver& solver = solvers::find_solver("ipopt");
  const auto least_excess = [&](int order, int delay, int sample) {
    const nlp::ConeProblem problem = cone_problem(task, order, {{delay, sample}});
    std::vector<double> start(static_cast<std::size_t>(order) + 1, 1.0 / (order + 1));
    start.push_back(5.0);
    const solvers::Result result = solver.solve(problem, start);
    // The linear limits of the blend may leave nothing at a place.
    if (result.claim == solvers::Claim::infeasible) return 1e9;
    EXPECT_NE(result.verification.verdict, solvers::Verdict::infeasible) << result.message;
    return result.x.back();
  };
  const int order = shortest.filter->order(), delay = shortest.corners[0].delay;
  double least = 1e9, shorter = 1e9;
  for (int k = (order + delay) / 2 - 2; k <= (order + delay) / 2 + 3; ++k) {
    least = std::min(least, least_excess(order, delay, k));
    shorter = std::min(shorter, least_excess(order, delay - 1, k));
  }
  EXPECT_LT(least, 1e-6);
  EXPECT_GT(shorter, 1e-6);
}

TEST(ConeFormulation, WhatIsNoConeIsRefused) {
  Task task = two_cones();
  EXPECT_THROW(cone_problem(task, 10, {{3, 5}}), std::invalid_argument);
  task.machine.axes[0].power_max = 20.0;
  EXPECT_THROW(cone_problem(task, 10, {{3, 5}, {3, 5}}), std::invalid_argument);
  nlp::ConeData data;
  data.c = {1.0};
  data.h = {1.0, 0.0};
  data.cones = {1};
  EXPECT_THROW(nlp::ConeProblem{data}, std::invalid_argument);
  data.cones = {2};
  data.g = {{2, 0, 1.0}};
  EXPECT_THROW(nlp::ConeProblem{data}, std::invalid_argument);
}

}  // namespace
}  // namespace accdec
