#include <algorithm>
#include <atomic>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include <accdec/certificate.hpp>
#include <accdec/exact/exact_run.hpp>
#include <accdec/task/order_bound.hpp>

#include "support/tasks.hpp"

// The bound of a proof that is stopped, and its continuation from there.

namespace accdec {
namespace {

using testing::plane_corner;
using testing::plane_task;

/// Friction takes 60 % of the force, at a sample period of a quarter: whether the force holds is only seen delay by
/// delay, a hundred of them.
Task friction() {
  Axis axis;
  axis.mass = 34.0;
  axis.damping = 840.0;
  axis.force_max = 465.0;
  axis.jerk_max = 2000.0;
  Task task = plane_task(axis, plane_corner("A", 90, 45, 1.0 / 3.0, 1.0 / 3.0), 640e-6);
  task.sample_period = 0.25e-3;
  return task;
}

Task random_corners(int count) {
  Axis axis;
  axis.acceleration_max = 6.0;
  axis.jerk_max = 600.0;
  std::mt19937 rng(7);
  std::uniform_real_distribution<double> u(0.0, 1.0);
  Task task = plane_task(axis, plane_corner("A", 90, 0, 0.1, 0.1), 50e-6);
  task.corners.clear();
  for (int j = 0; j < count; ++j) {
    const double feed = 0.04 + 0.08 * u(rng);
    TaskCorner corner = plane_corner("C" + std::to_string(j), 35.0 + 115.0 * u(rng), 90.0 * u(rng), feed, feed);
    corner.error_max = (10.0 + 100.0 * u(rng)) * 1e-6;
    corner.weight = 1.0 + j % 9;
    task.corners.push_back(std::move(corner));
  }
  task.design.order_max = 120;
  return task;
}

/// Stopped as soon as the bound is at least `enough`.
DesignResult stopped_at(const Task& task, double enough) {
  std::atomic<bool> cancel = false;
  ExactOptions options;
  options.cancel = &cancel;
  options.progress = [&](const ExactProgress& p) { cancel = cancel || p.bound >= enough; };
  return design_exact(task, options);
}

// Starts alone take that long (closed form), and that is known before anything else.
TEST(ExactBound, NoFilterIsShorterThanAStart) {
  const Task task = friction();
  const DesignResult result = stopped_at(task, 0.0);
  const double start = (order_lower_bound(task, 400) + 1) * task.sample_period;
  ASSERT_EQ(result.stop, StopReason::interrupted);
  ASSERT_TRUE(result.lower_bound);
  EXPECT_GE(*result.lower_bound, start * (1.0 - 1e-12));
  const CheckReport report = check_certificate(task, result);
  EXPECT_TRUE(report.accepted) << report.reason;
}

// Under an acceleration limit alone the boxcar is best: L taps, and the least d with
// 2 v T cos 45 deg sum_i max(i - (N + d)/2, 0)/L within the tolerance. Nearly as much is known without linear programs.
TEST(ExactBound, OfManyTapsNeedsNoLinearProgram) {
  Axis axis;
  axis.acceleration_max = 1.5;
  Task task = plane_task(axis, plane_corner("A", 90, 0, 0.1, 0.1), 100e-6);
  task.sample_period = 0.1e-3;
  task.design.order_max = 2000;
  const int taps = 667;  // 0.1 m/s over 1.5 m/s^2 and 0.1 ms
  int delay = -1;
  for (double error = 1.0; error > 100e-6;) {
    ++delay;
    double sum = 0.0;
    for (int i = 0; i < taps; ++i) sum += std::max(0.0, i - 0.5 * (taps - 1 + delay));
    error = 2.0 * 0.1 * task.sample_period * std::sqrt(0.5) * sum / taps;
  }
  const double least = (taps + delay) * task.sample_period;
  const DesignResult result = stopped_at(task, 0.0);
  ASSERT_EQ(result.stop, StopReason::interrupted);
  ASSERT_TRUE(result.lower_bound);
  EXPECT_LE(*result.lower_bound, least * (1.0 + 1e-9));
  EXPECT_GE(*result.lower_bound, 0.99 * least);
  EXPECT_LE(result.solver.evaluations, 1);
  const CheckReport report = check_certificate(task, result);
  EXPECT_TRUE(report.accepted) << report.reason;
}

// With several corners the taps alone count: 667 of them in one run, whatever the delays.
TEST(ExactBound, OfManyTapsAndCornersIsThatOfTheTaps) {
  Axis axis;
  axis.acceleration_max = 1.5;
  Task task = plane_task(axis, plane_corner("A", 90, 0, 0.1, 0.1), 100e-6);
  task.corners.push_back(task.corners.front());
  task.corners.back().name = "B", task.corners.back().error_max = 60e-6;
  task.sample_period = 0.1e-3, task.design.order_max = 2000;
  const DesignResult result = stopped_at(task, 0.0);
  ASSERT_EQ(result.stop, StopReason::interrupted);
  EXPECT_GE(result.lower_bound.value_or(0.0), 666 * task.sample_period);
  const CheckReport report = check_certificate(task, result);
  EXPECT_TRUE(report.accepted) << report.reason;
}

// Each corner by itself, its delay as dear as may be: the least delay at any order.
TEST(ExactBound, ManyCornersTakeAtLeastWhatEachTakesByItself) {
  const Task task = random_corners(12);
  double samples = order_lower_bound(task, 400) + 1;
  for (const TaskCorner& corner : task.corners) {
    Task one = task;
    one.corners = {corner};
    one.corners[0].weight = 1.0;
    one.design.runs = 1e-3;
    const DesignResult least = design_exact(one);
    ASSERT_EQ(least.status, Status::optimal);
    samples += corner.weight * least.corners[0].delay;
  }
  const DesignResult result = stopped_at(task, samples * task.sample_period * (1.0 - 1e-12));
  ASSERT_EQ(result.stop, StopReason::interrupted) << result.message;
  EXPECT_GE(*result.lower_bound, samples * task.sample_period * (1.0 - 1e-9));
  EXPECT_LE(*result.lower_bound, result.objective());
  const CheckReport report = check_certificate(task, result);
  EXPECT_TRUE(report.accepted) << report.reason;
}

TEST(ExactBound, TheSameOnAnyNumberOfThreads) {
  const Task task = random_corners(5);
  const DesignResult alone = design_exact(task);
  ASSERT_EQ(alone.status, Status::optimal) << alone.message;
  ASSERT_TRUE(alone.filter && alone.certificate);
  EXPECT_TRUE(check_certificate(task, alone).accepted);
  for (const int threads : {2, 3, 16}) {
    ExactOptions options;
    options.threads = threads;
    const DesignResult result = design_exact(task, options);
    ASSERT_TRUE(result.filter && result.certificate);
    EXPECT_TRUE(std::ranges::equal(result.filter->taps(), alone.filter->taps()));
    EXPECT_EQ(result.lower_bound, alone.lower_bound);
    EXPECT_EQ(result.solver.evaluations, alone.solver.evaluations);
    EXPECT_EQ(*result.certificate, *alone.certificate);
  }
}

TEST(ExactBound, GoesOnWhereItWasStopped) {
  for (const Task& task : {random_corners(1), random_corners(3)}) {
    const double whole = design_exact(task).objective();
    std::atomic<bool> cancel = false;
    int reports = 0;
    ExactOptions options;
    options.cancel = &cancel;
    options.progress = [&](const ExactProgress&) { cancel = cancel || ++reports % 3 == 0; };
    ExactRun run(task);
    DesignResult result;
    double bound = 0.0;
    for (int again = 0; again < 1000 && result.status != Status::optimal; ++again) {
      cancel = false;
      result = run.go_on(options);
      ASSERT_TRUE(result.lower_bound);
      EXPECT_GE(*result.lower_bound, bound);
      bound = *result.lower_bound;
      const CheckReport report = check_certificate(task, result);
      EXPECT_TRUE(report.accepted || !result.certificate) << report.reason;
    }
    ASSERT_EQ(result.status, Status::optimal);
    EXPECT_EQ(result.objective(), whole);
  }
}

}  // namespace
}  // namespace accdec
