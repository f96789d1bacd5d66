#include <atomic>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include <accdec/certificate.hpp>
#include <accdec/design.hpp>
#include <accdec/exact/exact.hpp>
#include <accdec/exact/relaxation.hpp>
#include <accdec/exact/search.hpp>
#include <accdec/verify.hpp>

#include "expect_proved.hpp"
#include "support/tasks.hpp"

namespace accdec {
namespace {

using testing::expect_proved;
using testing::plane_corner;
using testing::plane_task;

// One moving axis, straight on, no tolerance: the shortest filter under an acceleration limit is the boxcar of
// ceil(v/(a T)) taps.
TEST(Exact, AccelerationAloneGivesTheBoxcar) {
  for (const double a : {3.0, 7.0, 9.99, 10.01}) {
    Axis axis;
    axis.acceleration_max = a;
    Task task = plane_task(axis, plane_corner("A", 180, 0, 0.1, 0.1), std::nullopt);
    task.design.order_max = 60;
    const DesignResult result = design_exact(task);
    expect_proved(task, result);
    EXPECT_EQ(result.filter->order() + 1, static_cast<int>(std::ceil(0.1 / (a * 1e-3)))) << a;
    EXPECT_EQ(result.corners[0].delay, 0);
  }
}

// With a jerk limit too, taps are at most min(u, J(i+1), J(N+1-i)): the trapezoid is the largest, and enough when its
// sum reaches 1.
TEST(Exact, AccelerationAndJerkGiveTheTrapezoid) {
  for (const double j : {300.0, 800.0, 5000.0}) {
    Axis axis;
    axis.acceleration_max = 6.0;
    axis.jerk_max = j;
    Task task = plane_task(axis, plane_corner("A", 180, 0, 0.1, 0.1), std::nullopt);
    task.design.order_max = 80;
    const DesignResult result = design_exact(task);
    expect_proved(task, result);
    const double u = 6.0 * 1e-3 / 0.1, jerk = j * 1e-6 / 0.1;
    int order = 0;
    for (double sum = 0.0; sum < 1.0; ++order) {
      sum = 0.0;
      for (int i = 0; i <= order; ++i) sum += std::min({u, jerk * (i + 1), jerk * (order + 1 - i)});
      if (sum >= 1.0) break;
    }
    EXPECT_EQ(result.filter->order(), order) << j;
  }
}

// Undamped mode at 1/(2 n T), no residual, no other limit: two taps n apart (Singer and Seering's ZV shaper) and
// nothing shorter.
TEST(Exact, ZeroResidualGivesTheZeroVibrationShaper) {
  Task task = plane_task(Axis{}, plane_corner("A", 180, 0, 0.1, 0.1), std::nullopt);
  task.design.order_max = 30;
  task.machine.modes.push_back({50.0, 50.0, 0.0});
  const DesignResult result = design_exact(task);
  expect_proved(task, result);
  ASSERT_EQ(result.filter->order(), 10);
  EXPECT_NEAR(result.filter->tap(0), 0.5, 1e-9);
  EXPECT_NEAR(result.filter->tap(10), 0.5, 1e-9);
}

// Tolerance zero: leg 2 must not start to move before leg 1 has stopped, so the delay is the order of the shortest
// filter.
TEST(Exact, ToleranceZeroGivesTheExactStop) {
  Axis axis;
  axis.acceleration_max = 6.0;
  Task task = plane_task(axis, plane_corner("A", 90, 0, 0.1, 0.1), 0.0);
  task.design.order_max = 60;
  const DesignResult result = design_exact(task);
  expect_proved(task, result);
  EXPECT_EQ(result.filter->order() + result.corners[0].delay, 2 * 16);
  EXPECT_EQ(result.corners[0].corner_error, 0.0);
}

// Five taps J (1, 2, 3, 2, 1) of sum 1 are the only filter of order 4 under the jerk J v/T^2. Leg 1 stops an axis, and
// leg 2 starts it again in the same direction. Up to d = N + 1, the last step of leg 1 and the first of leg 2 meet at
// one sample, together 1.5 J. So the legs must be N + 2 apart.
TEST(Exact, JerkAcrossAnExactStopAsksForOneMoreSample) {
  Axis axis;
  axis.jerk_max = 0.1 / 9.0 / 1e-6 * (1.0 + 1e-8);
  Task task = plane_task(axis, plane_corner("A", 120, 0, 0.1, 0.1), 0.0);
  task.design.order_max = 4;
  const DesignResult result = design_exact(task);
  expect_proved(task, result);
  ASSERT_TRUE(result.filter);
  EXPECT_EQ(result.filter->order(), 4);
  EXPECT_EQ(result.corners[0].delay, 6);
  for (const int d : {4, 5}) EXPECT_FALSE(verify_by_simulation(task, *result.filter, {d}).feasible) << d;
}

TEST(Exact, DesignsThatRoundingKeepsFromVerifyingAreAskedForWithAMargin) {
  Axis axis;
  axis.acceleration_max = 8.0;
  axis.jerk_max = 1000.0;
  Task task = plane_task(axis, plane_corner("A", 90, 0, 0.1, 0.1), 100e-6);
  for (const double residual : {0.005, 0.002}) {
    task.machine.modes = {{38.0, 46.0, residual}};
    expect_proved(task, design_exact(task));
  }
}

// A residual this small is more than the linear program's own tolerance of it, and took the proof of an earlier version
// down.
TEST(Exact, ResidualsOfAThousandthAreProved) {
  Axis axis;
  axis.acceleration_max = 8.0;
  axis.jerk_max = 1000.0;
  Task task = plane_task(axis, plane_corner("A", 90, 0, 0.1, 0.1), 100e-6);
  task.machine.modes = {{38.0, 46.0, 0.001}};
  expect_proved(task, design_exact(task));
}

// Force rows of two axes, power and two bands: some of its parts have linear programs on the edge of being feasible.
TEST(Exact, PartsOnTheEdgeDoNotEndTheProof) {
  Axis x, y;
  x.name = "x0", y.name = "x1";
  x.acceleration_max = 4.525166988835355, x.jerk_max = 691.6727155025087;
  x.mass = 17.96361797525657, x.damping = 76.02906621765264, x.force_max = 90.18430250683483;
  x.power_max = 7.243153710716426;
  y.mass = 25.444405982247034, y.damping = 756.8663256936246, y.force_max = 213.71076968617967;
  y.power_max = 18.862239266895934;
  Task task = plane_task(x, plane_corner("A", 142.22706155045682, 180, 0.11700698, 0.06662119), 183.01961e-6);
  task.machine.axes = {x, y};
  task.sample_period = 2e-3;
  task.machine.modes = {{19.61374606757834, 19.972084116457452, 0.01}, {55.93239487751842, 61.525634365270264, 0.1}};
  expect_proved(task, design_exact(task));
}

// Twenty thousand rows and as many columns are 10 GB: said instead of asked for.
TEST(Exact, ProgrammesThatDoNotFitIntoMemoryAreNotBegun) {
  Axis axis;
  axis.acceleration_max = 6.0;
  axis.jerk_max = 500.0;
  Task task = plane_task(axis, plane_corner("A", 95, 0, 0.1, 0.1), 50e-6);
  for (const int order : {20'000, 1'000'000}) {
    task.design.order_min = task.design.order_max = order;
    const DesignResult result = design_exact(task);
    EXPECT_EQ(result.status, Status::failed);
    EXPECT_NE(result.message.find("memory"), std::string::npos) << result.message;
  }
}

TEST(Exact, EndsAtTheGapAskedFor) {
  Axis axis;
  axis.acceleration_max = 6.0;
  axis.jerk_max = 500.0;
  const Task task = plane_task(axis, plane_corner("A", 95, 0, 0.1, 0.1), 50e-6);
  const DesignResult best = design_exact(task);
  for (const double gap : {0.02, 0.1, 0.3}) {
    ExactOptions options;
    options.gap = gap;
    const DesignResult result = design_exact(task, options);
    ASSERT_TRUE(result.gap && result.lower_bound);
    EXPECT_LE(*result.gap, gap);
    EXPECT_LE(*result.lower_bound, best.objective() * (1.0 + 1e-12));
    EXPECT_GE(result.objective(), best.objective() * (1.0 - 1e-12));
    EXPECT_TRUE(check_certificate(task, result).accepted);
  }
}

// Why the search ended is a value of its own, whatever the message says.
TEST(Exact, SaysWhyItStopped) {
  Axis axis;
  axis.acceleration_max = 8.0;
  axis.jerk_max = 800.0;
  Task task = plane_task(axis, plane_corner("A", 77, 0, 0.1, 0.1), 50e-6);
  EXPECT_EQ(design_exact(task).stop, StopReason::finished);
  task.sample_period = 1e-4;  // hundreds of samples: far more than a millisecond's work
  ExactOptions options;
  options.time_limit = 1e-3;
  EXPECT_EQ(design_exact(task, options).stop, StopReason::time_limit);
  const std::atomic<bool> cancel = true;
  options = {};
  options.cancel = &cancel;
  EXPECT_EQ(design_exact(task, options).stop, StopReason::interrupted);
}

TEST(Exact, CertificatesOfInfeasibilityNameTheLimitsInConflict) {
  Axis axis;
  axis.acceleration_max = 1.0;
  axis.jerk_max = 1000.0;
  Task task = plane_task(axis, plane_corner("A", 90, 0, 0.1, 0.1), 100e-6);
  task.design.order_max = 40;  // 100 samples of acceleration are needed
  const DesignResult result = design_exact(task);
  ASSERT_EQ(result.status, Status::infeasible);
  ASSERT_NE(result.certificate, nullptr);
  const auto& conflict = std::get<proof::BranchAndBound>(result.certificate->proof).conflict;
  ASSERT_EQ(conflict.size(), 1u);
  EXPECT_NE(conflict[0].find("acceleration"), std::string::npos);
  EXPECT_TRUE(check_certificate(task, result).accepted);
}

TEST(Exact, AMarginIsHeld) {
  Axis axis;
  axis.acceleration_max = 8.0;
  axis.jerk_max = 1000.0;
  Task task = plane_task(axis, plane_corner("A", 90, 0, 0.1, 0.1), 100e-6);
  task.machine.modes = {{38.0, 46.0, 0.05}};
  const DesignResult shortest = design_exact(task);
  ASSERT_TRUE(shortest.filter);
  const exact::LimitModel model(task);
  exact::Box box;
  box.order = shortest.filter->order() + 8;
  const int d = shortest.corners[0].delay + 2, middle = (box.order + d + 1) / 2;
  box.corners = {{d, d, middle, middle}};
  const exact::Outcome outcome = exact::Relaxation(model, box.order, {}, 1e-3).solve(box, false);
  ASSERT_EQ(outcome.kind, exact::Outcome::feasible);
  EXPECT_EQ(verify_by_simulation(task, *outcome.filter, {d}).max_violation, 0.0);
  Task tighter = task;
  for (Axis& a : tighter.machine.axes) a.acceleration_max *= 1.0 - 1e-3, a.jerk_max *= 1.0 - 1e-3;
  tighter.machine.modes[0].residual_max *= 1.0 - 1e-3;
  *tighter.corners[0].error_max *= 1.0 - 1e-3;
  EXPECT_TRUE(verify_by_simulation(tighter, *outcome.filter, {d}).feasible);
}

// Linear programs among those of these tasks that Clp knows to be infeasible without giving a ray.
TEST(Exact, RefutesWithoutARay) {
  struct Case {
    double angle, tolerance, jerk;
  };
  for (const Case& c : {Case{60.0, 107.72173450159416e-6, 878.7639344404102}, Case{60.0, 500e-6, 154.4452104946379},
                        Case{120.0, 179.69068319023137e-6, 100.0}}) {
    Axis axis;
    axis.acceleration_max = 6.0;
    axis.jerk_max = c.jerk;
    const Task task = plane_task(axis, plane_corner("A", c.angle, 0, 0.1, 0.1), c.tolerance);
    expect_proved(task, design_exact(task));
  }
}

TEST(Exact, InfeasibleNamesTheConflict) {
  Axis axis;
  axis.acceleration_max = 6.0;
  axis.jerk_max = 5000.0;
  Task task = plane_task(axis, plane_corner("A", 90, 0, 0.1, 0.1), 50e-6);
  task.design.order_max = 30;
  task.corners[0].delay = 2;
  const DesignResult result = design_exact(task);
  ASSERT_EQ(result.status, Status::infeasible);
  EXPECT_FALSE(result.filter);
  EXPECT_NE(result.message.find("corner error A"), std::string::npos) << result.message;
  EXPECT_NE(result.message.find("delay of corner A"), std::string::npos) << result.message;
  EXPECT_EQ(result.message.find("jerk"), std::string::npos) << result.message;
  expect_proved(task, result);
}

}  // namespace
}  // namespace accdec
