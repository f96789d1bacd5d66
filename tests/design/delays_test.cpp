#include <atomic>

#include <gmock/gmock.h>

#include <accdec/corner.hpp>
#include <accdec/design.hpp>
#include <accdec/filter.hpp>
#include <accdec/task/check_delays.hpp>
#include <accdec/verify.hpp>

#include "support/tasks.hpp"
#include "support/tries.hpp"

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

// A filter with very many taps behaves like one in continuous time, whose smallest delay is known in closed form (Shih,
// Chen, Lee, Eq. 6 and its delay). The result agrees to a sample, and it is checked without trying every smaller delay.
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

// A filter's own limits and error as bounds, used up to a billionth more: the simulation grants half a billionth and
// not two.
TEST(DesignDelays, GrantsWhatTheSimulationGrants) {
  std::mt19937 rng(7);
  int compared = 0;
  for (int round = 0; round < 60; ++round) {
    Task loose = testing::random_task(rng, 1);
    loose.corners[0].speed_min = 0.0;
    for (Axis& axis : loose.machine.axes)
      axis.acceleration_max = axis.jerk_max = axis.force_max = axis.power_max = axis.regeneration_max = unlimited;
    loose.corners[0].error_max.reset();
    const int order = 4 + static_cast<int>(rng() % 25), delay = 1 + static_cast<int>(rng() % 6);
    loose.filter = FilterSpec{.kind = Shape::trapezoid, .order = order, .ramp = order / 4};
    const Filter filter = make_filter(*loose.filter);
    for (const double beyond : {0.0, 3e-10, 9.999e-10, 1.001e-9, 2.1e-9}) {
      Task task = loose;
      std::vector<CornerResult> corners;
      verify_by_simulation(task, filter, {delay}, nullptr, &corners);
      task.corners[0].error_max = corners[0].corner_error / (1.0 + beyond);
      if (!(*task.corners[0].error_max > 1e-9)) continue;
      int expected = 0;
      while (!verify_by_simulation(task, filter, {expected}).feasible) ++expected;
      if (beyond < 1e-9) {
        ASSERT_LE(expected, delay);
      }
      const DesignResult found = design_delays(task);
      ASSERT_EQ(found.status, Status::optimal) << beyond << found.message;
      EXPECT_EQ(found.corners[0].delay, expected) << beyond;
      EXPECT_EQ(check_smallest_delays(task, filter, {expected}), "") << beyond;
      // The same at a limit of the axes.
      Task pushed = task;
      pushed.machine.axes[0].acceleration_max = 1.0;
      std::vector<LimitUse> uses;
      verify_by_simulation(pushed, filter, {expected}, &uses);
      pushed.machine.axes[0].acceleration_max = uses.front().value / (1.0 + beyond);
      int first = 0;
      while (first <= order + 3 && !verify_by_simulation(pushed, filter, {first}).feasible) ++first;
      const DesignResult at_limit = design_delays(pushed);
      if (first > order + 3) {
        EXPECT_EQ(at_limit.status, Status::infeasible);
        EXPECT_EQ(check_no_delays(pushed, filter), "");
      } else {
        ASSERT_EQ(at_limit.status, Status::optimal) << beyond << at_limit.message;
        EXPECT_EQ(at_limit.corners[0].delay, first) << beyond;
        EXPECT_EQ(check_smallest_delays(pushed, filter, {first}), "") << beyond;
      }
      ++compared;
    }
  }
  EXPECT_GT(compared, 200);
}

// A design's taps put back as a given filter: the delays, and so the time, are the same.
TEST(DesignDelays, TapsOfADesignGetItsDelays) {
  std::mt19937 rng(24);
  int compared = 0;
  for (int round = 0; round < test_support::tries(60); ++round) {
    Task task = testing::random_task(rng, 1 + round % 2);
    task.design.order_max = 40;
    DesignOptions options;
    options.time_limit = 1.0;
    const DesignResult design = design_task(task, options);
    if (!design.has_design()) continue;
    const auto taps = design.filter->taps();
    task.filter = FilterSpec{.kind = Shape::taps, .taps = std::vector<double>(taps.begin(), taps.end())};
    const DesignResult again = design_task(task);
    ASSERT_TRUE(again.has_design()) << round << ": " << again.message;
    const double least = design.status == Status::optimal ? design.objective() * (1.0 - 1e-12) : 0.0;
    EXPECT_GE(again.objective(), least) << round;
    EXPECT_LE(again.objective(), design.objective() * (1.0 + 1e-12)) << round;
    ++compared;
  }
  EXPECT_GT(compared, test_support::tries(60) / 3);
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
