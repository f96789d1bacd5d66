#include <atomic>

#include <gmock/gmock.h>

#include <accdec/design/design.hpp>
#include <accdec/motion/linear.hpp>
#include <accdec/motion/shapes.hpp>
#include <accdec/task/check_delays.hpp>
#include <accdec/task/verifier.hpp>

#include "support/tasks.hpp"

namespace accdec {
namespace {

TEST(DesignDelays, IsTheFirstDelayThatSimulationAccepts) {
  std::mt19937 rng(41);
  int found = 0, none = 0;
  for (int round = 0; round < 400; ++round) {
    Task task = testing::random_task(rng, 1);
    // Limits loose enough that about half of the filters pass.
    for (Axis& axis : task.machine.axes) {
      axis.acceleration_max *= 3.0;
      axis.jerk_max *= 10.0;
      axis.force_max *= 3.0;
      axis.power_max *= 5.0;
      axis.regeneration_max *= 5.0;
    }
    const int order = 2 + static_cast<int>(rng() % 30);
    task.filter =
        FilterSpec{.kind = round % 2 == 0 ? Shape::trapezoid : Shape::s_curve, .order = order, .ramp = order / 4};
    const Filter filter = make_filter(*task.filter);
    int expected = -1;
    for (int d = 0; d <= order + 3 && expected < 0; ++d) {
      if (verify_by_simulation(task, filter, {d}).feasible) expected = d;
    }
    const DesignResult result = design_delays(task);
    if (expected < 0) {
      EXPECT_EQ(result.status, Status::infeasible);
      EXPECT_FALSE(result.filter.has_value());
      ++none;
    } else {
      ASSERT_EQ(result.status, Status::optimal) << result.message;
      EXPECT_EQ(result.corners[0].delay, expected);
      EXPECT_EQ(check_smallest_delays(task, filter, {expected}), "");
      if (expected <= order) {
        EXPECT_THAT(check_smallest_delays(task, filter, {order + 3}), ::testing::HasSubstr("holds every limit too"));
      }
      ++found;
    }
  }
  EXPECT_GT(found, 80);
  EXPECT_GT(none, 80);
}

// A filter of very many taps is one in continuous time, of which the smallest delay is known in closed form (Shih,
// Chen, Lee, Eq. 6 and its delay): to a sample, and it is checked without trying every smaller one.
TEST(DesignDelays, OfAHundredThousandTapsAreCheckedLikeOfTen) {
  const int order = 100'000;
  const double feed = 0.1, error = 50e-6, period = 1e-6, angle = testing::degrees(95);
  Task task = testing::plane_task({}, testing::plane_corner("A", 95, 0, feed, feed), error);
  task.sample_period = period;
  task.filter = FilterSpec{.kind = Shape::boxcar, .order = order};
  const double expected = LinearCorner(angle, feed, feed, (order + 1) * period).smallest_delay(error) / period;
  const int delay = design_delays(task).corners[0].delay;
  EXPECT_NEAR(delay, expected, 2.0);
  const Filter filter = make_filter(*task.filter);
  EXPECT_EQ(check_smallest_delays(task, filter, {delay}), "");
  EXPECT_THAT(check_smallest_delays(task, filter, {delay + 1}), ::testing::HasSubstr("holds every limit too"));
  EXPECT_EQ(check_smallest_delays(task, filter, {delay}, [] { return true; }), "not checked in time");
}

TEST(DesignDelays, StopsAtItsTimeLimit) {
  Task task = testing::plane_task({}, testing::plane_corner("A", 90, 0, 0.1, 0.1), 20e-6);
  task.filter = FilterSpec{.kind = Shape::hann, .order = 40};
  DesignOptions options;
  options.time_limit = 1e-9;
  const DesignResult result = design_delays(task, options);
  EXPECT_EQ(result.status, Status::failed);
  EXPECT_THAT(result.message, ::testing::HasSubstr("stopped at corner 1 of 1"));
  std::atomic<bool> cancel{true};
  options.time_limit = 600.0;
  options.cancel = &cancel;
  EXPECT_EQ(design_delays(task, options).status, Status::failed);
}

TEST(DesignDelays, KeepsGivenDelays) {
  Task task = testing::plane_task({}, testing::plane_corner("A", 90, 0, 0.1, 0.1), 20e-6);
  task.filter = FilterSpec{.kind = Shape::hann, .order = 40};
  task.corners[0].delay = 39;
  EXPECT_EQ(design_delays(task).corners[0].delay, 39);
  task.corners[0].delay = 0;
  const DesignResult result = design_delays(task);
  EXPECT_EQ(result.status, Status::infeasible);
  EXPECT_THAT(result.message, ::testing::HasSubstr("at the given delay: corner error"));
}

}  // namespace
}  // namespace accdec
