#include <gtest/gtest.h>

#include <accdec/design.hpp>
#include <accdec/design/coarse_design.hpp>
#include <accdec/task.hpp>
#include <accdec/verify.hpp>

#include "support/paths.hpp"

// Designs of many taps begin with a design at a longer period.

namespace accdec {
namespace {

Task shipped(const char* problem, double period) {
  Task task = read_task(test_support::source_folder() + "/problems/" + problem);
  task.filter.reset();
  task.sample_period = period;
  task.design.order_max = 2000;
  return task;
}

/// The optimum at 1 ms is proved. With eight times as many taps, what is found at once takes at most 8 % more.
TEST(CoarseDesign, IsNearTheOptimumOfALongerPeriod) {
  for (const char* problem : {"corner/regeneration.toml", "corner/six-axes.toml", "corner/acceleration-jerk.toml"}) {
    const DesignResult longer = design_task(shipped(problem, 1e-3));
    ASSERT_EQ(longer.status, Status::optimal) << problem;
    const Task task = shipped(problem, 0.125e-3);
    const auto found = coarse_design(task, {}, 20.0);
    if (!found) {
      EXPECT_STREQ(problem, "corner/acceleration-jerk.toml") << "only its acceleration takes few taps";
      continue;
    }
    EXPECT_TRUE(found->verification.feasible) << problem;
    EXPECT_TRUE(verify_result(*found).accepted) << problem;
    EXPECT_LT(found->objective(), 1.08 * longer.objective()) << problem;
  }
}

/// Two thousand taps. The first filter that holds alone needs a delay at which the legs almost part, 19 % more than the
/// optimum at 0.5 ms. A longer filter has a shorter delay.
TEST(CoarseDesign, HasShortDelaysWithVeryManyTaps) {
  const auto at = [](double period, int order_max) {
    Task task = shipped("corner/acceleration-jerk.toml", period);
    task.design.order_max = order_max;
    for (Axis& axis : task.machine.axes) axis.acceleration_max = 1.2, axis.jerk_max = 60.0;
    return task;
  };
  const DesignResult longer = design_task(at(0.5e-3, 250));
  ASSERT_EQ(longer.status, Status::optimal);
  const auto found = coarse_design(at(0.05e-3, 2500), {}, 20.0);
  ASSERT_TRUE(found);
  EXPECT_TRUE(verify_result(*found).accepted);
  EXPECT_LT(found->objective(), 1.15 * longer.objective());
}

/// Behind a servo the tail, not the filter, ends the first leg.
TEST(CoarseDesign, WaitsForTheTailOfAServo) {
  const auto at = [](double period, int order_max) {
    Task task = shipped("corner/acceleration-jerk.toml", period);
    task.design.order_max = order_max;
    for (Axis& axis : task.machine.axes) axis.acceleration_max = 2.0, axis.jerk_max = 50.0, axis.servo_gain = 50.0;
    return task;
  };
  const DesignResult longer = design_task(at(2e-3, 50));
  ASSERT_EQ(longer.status, Status::optimal);
  const auto found = coarse_design(at(0.25e-3, 400), {}, 20.0);
  ASSERT_TRUE(found);
  EXPECT_TRUE(verify_result(*found).accepted);
  EXPECT_LT(found->objective(), 1.08 * longer.objective());
}

TEST(CoarseDesign, IsForFreeFiltersOfManyTapsOnly) {
  EXPECT_FALSE(coarse_design(shipped("corner/regeneration.toml", 1e-3), {}, 20.0));
  Task smoothed = shipped("corner/regeneration.toml", 0.125e-3);
  smoothed.machine.prefilter_taps = {0.5, 0.5};
  EXPECT_FALSE(coarse_design(smoothed, {}, 20.0)) << "the smoothing is given in samples of the period";
  Task given = shipped("corner/regeneration.toml", 0.125e-3);
  given.filter = FilterSpec{.kind = Shape::boxcar, .order = 300};
  EXPECT_FALSE(coarse_design(given, {}, 20.0));
}

/// A bound on the order is kept, even if that leaves no design.
TEST(CoarseDesign, KeepsTheOrder) {
  Task task = shipped("corner/regeneration.toml", 0.125e-3);
  task.design.order_max = 380;
  const auto found = coarse_design(task, {}, 20.0);
  if (found) {
    EXPECT_LE(found->filter->order(), 380);
  }
}

}  // namespace
}  // namespace accdec
