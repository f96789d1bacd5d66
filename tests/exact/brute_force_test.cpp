#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include <accdec/design.hpp>
#include <accdec/exact/exact.hpp>
#include <accdec/exact/relaxation.hpp>
#include <accdec/exact/search.hpp>

#include "expect_proved.hpp"
#include "support/tasks.hpp"
#include "support/tries.hpp"

// The exact method against every order, delay and sample tried by a linear program of its own.

namespace accdec {
namespace {

using testing::expect_proved;
using testing::plane_corner;
using testing::plane_task;

/// The least objective, samples: every order, delay and sample by a linear program of its own, without boxes,
/// targets, monotony or proofs.
double brute_force(const Task& task) {
  const exact::LimitModel model(task);
  double best = std::numeric_limits<double>::infinity();
  for (int n = task.design.order_min; n <= task.design.order_max; ++n) {
    for (int d = task.corners[0].delay.value_or(0); d <= task.corners[0].delay.value_or(n + 2); ++d) {
      const double w = task.corners[0].weight;
      const double value =
          task.design.objective == Objective::corner ? w * (n + 1 + d) : task.design.runs * (n + 1) + w * d;
      if (value >= best) break;
      for (int k = 0; k <= n + d + 1; ++k) {
        exact::Relaxation relaxation(model, n);
        if (relaxation.solve({n, {{d, d, k, k}}}, task.design.symmetric).kind == exact::Outcome::feasible) {
          best = value;
          break;
        }
      }
    }
  }
  return best;
}

Task random_convex(std::mt19937& rng) {
  Task task = testing::random_task(rng, 1);
  std::uniform_real_distribution<double> u(0.0, 1.0);
  task.sample_period = 4e-3;
  for (Axis& axis : task.machine.axes) {
    axis.power_max = axis.regeneration_max = unlimited;
    if (axis.force_max < unlimited) axis.force_max += 1.2 * axis.damping * 0.35;
  }
  task.corners[0].speed_min = 0.0;
  task.corners[0].error_max = 0.35 * 4e-3 * u(rng);
  task.design.order_max = 11;
  if (u(rng) < 0.2) task.corners[0].delay = static_cast<int>(5 * u(rng));
  if (u(rng) < 0.2) task.corners[0].error_max.reset();
  if (u(rng) < 0.2) task.design.symmetric = true;
  if (u(rng) < 0.2) task.machine.modes.push_back({20.0, 30.0, 0.3 * u(rng) + 0.05});
  return task;
}

TEST(ExactBruteForce, OneCornerAgrees) {
  std::mt19937 rng(7);
  int found = 0, none = 0;
  for (int i = 0; i < 300; ++i) {
    Task task = random_convex(rng);
    task.design.objective = i % 3 == 0 ? Objective::corner : Objective::cycle;
    task.design.runs = i % 3 == 1 ? 1.0 : 0.4;
    const DesignResult result = design_exact(task);
    SCOPED_TRACE(i);
    const double expected = brute_force(task);
    if (std::isinf(expected)) {
      EXPECT_EQ(result.status, Status::infeasible);
      ++none;
    } else {
      EXPECT_NEAR(result.objective() / task.sample_period, expected, 1e-9) << result.message;
      ++found;
    }
    expect_proved(task, result);
    if (HasFailure()) break;
  }
  EXPECT_GT(found, 100);
  EXPECT_GT(none, 5);
}

// Two corners of different weight that share the filter: all orders, pairs of delays and pairs of samples.
TEST(ExactBruteForce, TwoCornersAgree) {
  std::mt19937 rng(11);
  std::uniform_real_distribution<double> u(0.0, 1.0);
  int found = 0;
  for (int i = 0; i < 12; ++i) {
    SCOPED_TRACE(i);
    Task task = testing::random_task(rng, 2);
    task.design.objective = i % 2 == 0 ? Objective::corner : Objective::cycle;
    task.design.runs = 1.7;
    task.sample_period = 8e-3;
    task.design.order_max = 4;
    for (Axis& axis : task.machine.axes) {
      axis.power_max = axis.regeneration_max = axis.force_max = axis.jerk_max = unlimited;
      axis.acceleration_max = 12.0 + 10.0 * u(rng);
    }
    for (TaskCorner& c : task.corners) c.speed_min = 0.0, c.error_max = 0.6 * 8e-3 * c.geometry().feed_in * u(rng);
    const exact::LimitModel model(task);
    double best = std::numeric_limits<double>::infinity();
    for (int n = 1; n <= 4; ++n) {
      exact::Relaxation relaxation(model, n);
      for (int d1 = 0; d1 <= n + 1; ++d1) {
        for (int d2 = 0; d2 <= n + 1; ++d2) {
          const double w1 = task.corners[0].weight, w2 = task.corners[1].weight;
          const double value = (i % 2 == 0 ? (w1 + w2) * (n + 1) : 1.7 * (n + 1)) + w1 * d1 + w2 * d2;
          for (int k1 = 0; k1 <= n + d1 + 1; ++k1) {
            for (int k2 = 0; k2 <= n + d2 + 1 && value < best; ++k2) {
              if (relaxation.solve({n, {{d1, d1, k1, k1}, {d2, d2, k2, k2}}}, false).filter) best = value;
            }
          }
        }
      }
    }
    const DesignResult result = design_exact(task);
    expect_proved(task, result);
    if (std::isinf(best)) {
      EXPECT_EQ(result.status, Status::infeasible);
    } else {
      ++found;
      EXPECT_NEAR(result.objective() / task.sample_period, best, 1e-9 * best);
    }
    if (HasFailure()) break;
  }
  EXPECT_GT(found, 3);
}

// The search with a target knows no lemmas and no windows: it finds nothing below what they prove, but something at it.
TEST(ExactBruteForce, ThreeCornersAgreeWithTheSearchBelowATarget) {
  std::mt19937 rng(5);
  std::uniform_real_distribution<double> u(0.0, 1.0);
  for (int i = 0; i < test_support::tries(6); ++i) {
    SCOPED_TRACE(i);
    Axis axis;
    axis.acceleration_max = 8.0;
    axis.jerk_max = i % 3 == 1 ? unlimited : 4000.0;
    if (i % 3 == 1) axis.mass = 20.0, axis.force_max = 150.0, axis.damping = 200.0;
    Task task = plane_task(axis, plane_corner("A", 40 + 100 * u(rng), 30, 0.1, 0.1), 80e-6 * (1.0 + u(rng)));
    for (const char* name : {"B", "C"}) {
      const double feed = 0.05 + 0.05 * u(rng);
      const Task other = plane_task(axis, plane_corner(name, 40 + 100 * u(rng), 0, feed, i < 3 ? feed : 0.06), 60e-6);
      task.corners.push_back(other.corners[0]);
      task.corners.back().weight = 1.0 + std::floor(4.0 * u(rng));
    }
    if (i % 3 == 2) task.machine.modes = {{60.0, 70.0, 0.3}};
    task.sample_period = 2e-3;
    task.design.order_max = 60;
    task.design.runs = i % 2 == 0 ? 1.0 : 8.0;
    const DesignResult result = design_exact(task);
    expect_proved(task, result);
    if (HasFailure()) break;
    const double best = result.objective() / task.sample_period;
    const auto below = [&](double target) {
      exact::Workbench bench(task, [] { return false; });
      return exact::Search(bench).below(target);
    };
    EXPECT_EQ(below(best), exact::Search::Answer::proved);
    EXPECT_EQ(below(best * (1.0 + 1e-6)), exact::Search::Answer::found);
  }
}

// The linear program holds a residual of half a percent to 1e-10, which is relatively more than the verifier grants. So
// the design must be computed again with a margin.

}  // namespace
}  // namespace accdec
