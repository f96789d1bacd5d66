#include <cmath>
#include <random>

#include <gmock/gmock.h>

#include <accdec/design/standard_shapes.hpp>
#include <accdec/motion/shapes.hpp>
#include <accdec/task/verifier.hpp>

#include "support/tasks.hpp"

namespace accdec {
namespace {

using testing::plane_corner;
using testing::plane_task;
using testing::random_task;

TEST(StandardShapes, BoxcarUnderAccelerationAloneIsTheClosedForm) {
  Axis axis;
  axis.acceleration_max = 6.0;
  // Exact stop along x: N + 1 = ceil(v / (a T)) taps, and as many samples less one until the legs no longer overlap.
  Task task = plane_task(axis, plane_corner("A", 90, 0, 0.1, 0.1), 0.0);
  const StandardShapeResult best = best_standard_shape(task, Shape::boxcar);
  ASSERT_TRUE(best.spec);
  EXPECT_EQ(best.spec->order + 1, static_cast<int>(std::ceil(0.1 / (6.0 * 1e-3))));
  EXPECT_EQ(best.result.corners.at(0).delay, best.spec->order);
  EXPECT_EQ(best.result.status, Status::feasible);
  EXPECT_TRUE(best.result.verification.feasible);
}

TEST(StandardShapes, TrapezoidUnderAccelerationAndJerkIsTheClosedForm) {
  Axis axis;
  axis.acceleration_max = 5.0;
  axis.jerk_max = 500.0;
  // v = 0.1 m/s: a ramp of a/(jT) = 10 steps and v/(aT) = 20 taps of plateau height: convolution of boxcars of 20 and
  // 10, 29 taps.
  Task task = plane_task(axis, plane_corner("A", 90, 0, 0.1, 0.1), 0.0);
  const StandardShapeResult best = best_standard_shape(task, Shape::trapezoid);
  ASSERT_TRUE(best.spec);
  EXPECT_EQ(best.spec->order + 1, 29);
  EXPECT_EQ(best.spec->ramp, 9);
}

/// Every order, every parameter, every delay, judged by simulation alone: shares nothing with the search but the
/// shapes.
double brute_force(const Task& task, Shape shape, int order_max) {
  double best = unlimited;
  for (int order = task.design.order_min; order <= order_max; ++order) {
    const int parameters = shape == Shape::trapezoid       ? order / 2 + 1
                           : shape == Shape::blackman_sinc ? blackman_sinc_cutoffs
                                                           : 1;
    if (order < 2 && shape != Shape::boxcar && shape != Shape::trapezoid) continue;
    for (int p = 0; p < parameters; ++p) {
      FilterSpec spec{shape, order, 2.0 / order * (p + 1) / blackman_sinc_cutoffs, p, {}};
      const Filter filter = make_filter(spec);
      const bool cycle = task.design.objective == Objective::cycle;
      double cost = cycle ? task.design.runs * (order + 1.0) : 0.0;
      for (const TaskCorner& corner : task.corners) {
        Task single = task;
        single.corners = {corner};
        int delay = 0;
        while (delay <= order + 1 && !verify_by_simulation(single, filter, {delay}).feasible) ++delay;
        cost += delay <= order + 1 ? corner.weight * ((cycle ? 0.0 : order + 1.0) + delay) : unlimited;
      }
      best = std::min(best, cost * task.sample_period);
    }
  }
  return best;
}

TEST(StandardShapes, AgreeWithTryingEverything) {
  std::mt19937 rng(7);
  int found = 0;
  for (int trial = 0; trial < 72; ++trial) {
    Task task = random_task(rng, 1 + trial % 2);
    task.design.order_max = 24;
    task.design.objective = trial % 4 < 2 ? Objective::cycle : Objective::corner;
    task.design.runs = 1.5;
    const Shape shape = standard_shapes[static_cast<std::size_t>(trial) % standard_shapes.size()];
    const double expected = brute_force(task, shape, 24);
    const StandardShapeResult best = best_standard_shape(task, shape);
    SCOPED_TRACE(::testing::Message() << "trial " << trial << ", " << to_string(shape));
    if (expected == unlimited) {
      EXPECT_FALSE(best.spec);
      EXPECT_EQ(best.result.status, Status::infeasible);
    } else {
      ++found;
      ASSERT_TRUE(best.spec) << best.result.message;
      EXPECT_EQ(best.result.status, Status::feasible) << best.result.message;
      EXPECT_NEAR(best.result.objective(), expected, 1e-12);
    }
  }
  EXPECT_GE(found, 12);
}

TEST(StandardShapes, BoxcarIsATrapezoidAndNeverBeatsIt) {
  std::mt19937 rng(3);
  for (int trial = 0; trial < 20; ++trial) {
    const Task task = random_task(rng, 2);
    const auto trapezoid = best_standard_shape(task, Shape::trapezoid),
               plain = best_standard_shape(task, Shape::boxcar);
    if (plain.spec) {
      ASSERT_TRUE(trapezoid.spec);
      EXPECT_LE(trapezoid.result.objective(), plain.result.objective() * (1 + 1e-12));
    }
  }
}

TEST(StandardShapes, GivenDelaysStayAndGivenTapsAreRefused) {
  Axis axis;
  axis.acceleration_max = 5.0;
  Task task = plane_task(axis, plane_corner("A", 90, 0, 0.1, 0.1), std::nullopt);
  task.corners[0].delay = 3;
  const auto best = best_standard_shape(task, Shape::hann);
  ASSERT_TRUE(best.spec);
  EXPECT_EQ(best.result.corners.at(0).delay, 3);
  EXPECT_THROW(best_standard_shape(task, Shape::taps), std::invalid_argument);
}

TEST(StandardShapes, ContradictionsAreNamed) {
  Axis axis;
  axis.velocity_max = 0.05;
  const auto best = best_standard_shape(plane_task(axis, plane_corner("A", 90, 0, 0.1, 0.1), 1e-4), Shape::boxcar);
  EXPECT_EQ(best.result.status, Status::infeasible);
  EXPECT_THAT(best.result.message, ::testing::HasSubstr("velocity"));
}

}  // namespace
}  // namespace accdec
