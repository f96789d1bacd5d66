#include <string>

#include <sys/resource.h>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <accdec/corner.hpp>
#include <accdec/design.hpp>
#include <accdec/design/fixed_order.hpp>
#include <accdec/filter.hpp>
#include <accdec/task.hpp>
#include <accdec/task/order_bound.hpp>
#include <accdec/verify.hpp>

#include "support/tasks.hpp"

namespace accdec {
namespace {

using testing::plane_corner;
using testing::plane_task;

int total(const DesignResult& result) {
  return result.filter->order() + result.corners[0].delay;
}

/// Least N + d over boxcars or trapezoids that hold the limits: an upper bound any design must reach.
int best_trapezoid(const Task& task) {
  int best = 1 << 20;
  for (int order = 1; order <= 80; ++order) {
    for (int ramp = 0; ramp <= order / 2; ++ramp) {
      const Filter filter = trapezoid(order, ramp);
      const TaskCorner& corner = task.corners[0];
      const double period = task.sample_period;
      const int d = DelayFinder(filter)(corner.geometry().cos_interior(), corner.geometry().feed_in * period,
                                        corner.geometry().feed_out * period, *corner.error_max);
      if (order + d < best && verify_by_simulation(task, filter, {d}).feasible) best = order + d;
    }
  }
  return best;
}

TEST(DesignNlp, AccelerationOnlyIsAsShortAsTheBoxcar) {
  for (const double tolerance : {10e-6, 30e-6, 100e-6, 300e-6}) {
    Axis axis;
    axis.acceleration_max = 6.0;
    const Task task = plane_task(axis, plane_corner("A", 90, 0, 0.1, 0.1), tolerance);
    const DesignResult result = design_nlp(task);
    ASSERT_EQ(result.status, Status::feasible) << result.message;
    EXPECT_TRUE(result.verification.feasible);
    EXPECT_LE(total(result), best_trapezoid(task));
  }
}

TEST(DesignNlp, IsNeverLongerThanTheBestTrapezoid) {
  for (const double angle : {30.0, 95.0, 150.0}) {
    Axis axis;
    axis.acceleration_max = 6.0;
    axis.jerk_max = 500.0;
    const Task task = plane_task(axis, plane_corner("A", angle, 10, 0.1, 0.08), 40e-6);
    const DesignResult result = design_nlp(task);
    ASSERT_EQ(result.status, Status::feasible) << result.message;
    EXPECT_LE(total(result), best_trapezoid(task)) << angle;
  }
}

/// A contour bound, alone or beside a tolerance: no longer than the best trapezoid at every delay, by the verifier.
TEST(DesignNlp, ContourIsNoLongerThanTheBestTrapezoid) {
  for (const bool alone : {true, false}) {
    for (const double angle : alone ? std::vector{60.0, 140.0} : std::vector{95.0}) {
      Axis axis;
      axis.acceleration_max = 6.0;
      axis.jerk_max = 500.0;
      Task task =
          plane_task(axis, plane_corner("A", angle, 10, 0.1, 0.09), alone ? std::nullopt : std::optional(60e-6));
      task.corners[0].contour_max = 25e-6;
      const DesignResult result = design_nlp(task);
      ASSERT_EQ(result.status, Status::feasible) << result.message;
      int best = total(result) + 1;  // longer ones say nothing
      for (int order = 15; order < best; order += 2) {
        for (int ramp = 0; ramp <= order / 2; ramp += 3) {
          const Filter filter = trapezoid(order, ramp);
          for (int d = 0; order + d < best && d <= order + 1; ++d) {
            if (measure(Blend(filter, task.corners[0].geometry(), d, task.sample_period)).contour_deviation > 25e-6)
              continue;
            if (verify_by_simulation(task, filter, {d}).feasible) best = order + d;
          }
        }
      }
      EXPECT_LE(total(result), best) << angle << (alone ? ", alone" : "");
    }
  }
}

TEST(DesignNlp, ShapesThatLimitsAskForAreFound) {
  // Power, regeneration, smallest speed and a vibration band: verified designs that use the limit up.
  struct Case {
    LimitKind kind;
    Task task;
  };
  std::vector<Case> cases;
  Axis axis;
  axis.mass = 34.0;
  axis.damping = 60.0;
  axis.force_max = 465.0;
  axis.power_max = 140.0;
  cases.push_back({LimitKind::power, plane_task(axis, plane_corner("A", 90, 0, 0.5, 0.5), 200e-6)});
  axis.power_max = unlimited;
  axis.regeneration_max = 70.0;
  cases.push_back({LimitKind::regeneration, plane_task(axis, plane_corner("A", 120, 0, 0.4, 0.4), 150e-6)});
  Axis smooth;
  smooth.acceleration_max = 8.0;
  smooth.jerk_max = 1000.0;
  cases.push_back({LimitKind::vibration, plane_task(smooth, plane_corner("A", 90, 0, 0.1, 0.1), 100e-6)});
  cases.back().task.machine.modes = {{38.0, 46.0, 0.05}};
  for (const Case& c : cases) {
    const DesignResult result = design_nlp(c.task);
    ASSERT_EQ(result.status, Status::feasible) << to_string(c.kind) << ": " << result.message;
    double use = 0.0;
    for (const LimitUse& limit : result.limits) {
      if (limit.kind == c.kind) use = std::max(use, limit.utilisation);
    }
    EXPECT_GT(use, 0.9) << to_string(c.kind);
    EXPECT_LE(use, 1.0 + verification_tolerance);
  }
}

TEST(DesignNlp, SharesOneFilterAmongCorners) {
  Axis axis;
  axis.acceleration_max = 6.0;
  axis.jerk_max = 600.0;
  Task task = plane_task(axis, plane_corner("A", 90, 0, 0.1, 0.1), 30e-6);
  task.corners.push_back(plane_corner("B", 135, 45, 0.1, 0.07));
  task.corners.back().error_max = 50e-6;
  task.corners.back().weight = 0.2;
  const DesignResult result = design_nlp(task);
  ASSERT_EQ(result.status, Status::feasible) << result.message;
  // Each delay is the smallest for the filter found.
  const DelayFinder smallest(*result.filter);
  for (std::size_t j = 0; j < 2; ++j) {
    const TaskCorner& corner = task.corners[j];
    EXPECT_EQ(result.corners[j].delay, smallest(corner.geometry().cos_interior(), corner.geometry().feed_in * 1e-3,
                                                corner.geometry().feed_out * 1e-3, *corner.error_max));
  }
}

TEST(DesignNlp, TakesFixedOrderAndFixedDelay) {
  Axis axis;
  axis.acceleration_max = 6.0;
  Task task = plane_task(axis, plane_corner("A", 90, 0, 0.1, 0.1), 100e-6);
  task.design.order_min = task.design.order_max = 30;
  DesignResult result = design_nlp(task);
  ASSERT_EQ(result.status, Status::feasible) << result.message;
  EXPECT_EQ(result.filter->order(), 30);
  task.design.order_min = 1;
  task.design.order_max = 400;
  task.corners[0].delay = 12;
  result = design_nlp(task);
  ASSERT_EQ(result.status, Status::feasible) << result.message;
  EXPECT_EQ(result.corners[0].delay, 12);
}

TEST(DesignNlp, SymmetricTapsWhenAsked) {
  Axis axis;
  axis.mass = 34.0;
  axis.damping = 500.0;
  axis.force_max = 300.0;
  Task task = plane_task(axis, plane_corner("A", 90, 0, 0.3, 0.3), 150e-6);
  task.design.symmetric = true;
  const DesignResult result = design_nlp(task);
  ASSERT_EQ(result.status, Status::feasible) << result.message;
  const int n = result.filter->order();
  for (int i = 0; i <= n; ++i) EXPECT_NEAR(result.filter->tap(i), result.filter->tap(n - i), 1e-9);
}

TEST(DesignTask, ContradictionsAreInfeasibleAndNamed) {
  Axis axis;
  axis.mass = 34.0;
  axis.damping = 5000.0;
  axis.force_max = 300.0;
  const DesignResult result = design_task(plane_task(axis, plane_corner("A", 90, 0, 0.1, 0.1), 50e-6));
  EXPECT_EQ(result.status, Status::infeasible);
  EXPECT_THAT(result.message, ::testing::HasSubstr("force x"));
  EXPECT_FALSE(result.filter.has_value());
}

TEST(DesignTask, NamesToleranceAndSmallestSpeedThatContradict) {
  Axis axis;
  axis.acceleration_max = 10.0;
  axis.jerk_max = 1500.0;
  Task task = plane_task(axis, plane_corner("A", 90, 0, 0.1, 0.1), 20e-6);
  task.corners[0].speed_min = 0.06;
  task.design.order_max = 40;
  const DesignResult result = design_nlp(task);
  EXPECT_EQ(result.status, Status::failed);
  EXPECT_FALSE(result.filter.has_value());
  EXPECT_THAT(result.message, ::testing::HasSubstr("jerk, corner error A, smallest speed A"));
  const DesignResult by_default = design_task(task);
  // The exact method proves it.
  EXPECT_EQ(by_default.status, Status::infeasible);
  for (const char* limit : {"jerk", "corner error A", "smallest speed A"}) {
    EXPECT_THAT(by_default.message, ::testing::HasSubstr(limit));
  }
}

TEST(DesignTask, UnknownSolverListsTheKnown) {
  DesignOptions options;
  options.method = Method::nlp;
  options.nlp.solver = "cplex";
  const Task task = plane_task({}, plane_corner("A", 90, 0, 0.1, 0.1), 50e-6);
  try {
    design_task(task, options);
    FAIL();
  } catch (const std::invalid_argument& e) {
    EXPECT_THAT(e.what(), ::testing::HasSubstr("ipopt"));
  }
}

/// User time of this thread, s.
double user_time() {
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  return static_cast<double>(usage.ru_utime.tv_sec) + 1e-6 * static_cast<double>(usage.ru_utime.tv_usec);
}

Task corners_of_all_angles(int count) {
  std::string text =
      "sample_period_ms = 1\n[[axis]]\nvelocity_max_mm_s = 500\nacceleration_max_mm_s2 = 5000\n"
      "jerk_max_mm_s3 = 400000\n";
  for (int j = 0; j < count; ++j) {
    text +=
        fmt::format("[[corner]]\nangle_deg = {}\nfeed_in_mm_min = 6000\nerror_max_um = 20\n", 30.0 + 140.0 * j / count);
  }
  return parse_task(text, "task.toml");
}

// With 600 corners a step took 2 s: too long for a share of 0.7 s, not for one of some minutes.
TEST(DesignNlp, StepsOnManyCornersAreBegunIfTheyEndInTime) {
  const Task task = corners_of_all_angles(600);
  EXPECT_THAT(step_too_long(task, 19, 0.7), ::testing::HasSubstr("a step of a local solver on 600 corners"));
  EXPECT_EQ(step_too_long(task, 19, 200.0), "");
  EXPECT_EQ(step_too_long(corners_of_all_angles(200), 19, 0.7), "");
  DesignOptions options;
  options.time_limit = 0.7;
  const DesignResult result = design_nlp(task, options);
  EXPECT_EQ(result.stop, StopReason::time_limit);
  EXPECT_EQ(result.solver.evaluations, 0);
}

// A factorisation cannot be stopped. With plain minimum degree one of 200 corners took seconds, whatever the time
// limit, because every exchanged pivot fills the factors in.
TEST(DesignNlp, StepsOnManyCornersAreShortBesideThoseOfPlainMinimumDegree) {
  const Task task = corners_of_all_angles(200);
  DesignOptions options;
  options.nlp.options.evaluation_limit = 8;
  const auto spent = [&] {
    const double before = user_time();
    FixedOrderDesigner(task, options).relaxed(19);
    return user_time() - before;
  };
  const double ours = spent();
  options.nlp.options.native["mumps_pivot_order"] = "0";
  EXPECT_LT(ours, 0.5 * spent());
}

}  // namespace
}  // namespace accdec
