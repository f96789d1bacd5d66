#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <accdec/design.hpp>
#include <accdec/plot/plot_result.hpp>
#include <accdec/task.hpp>

namespace accdec {
namespace {

// Averages of 40 and 30 samples have the order 68. A control that stops exactly waits so long at each corner:
// 69 + 68 samples of today's filter.
TEST(PlotToday, FilterOfTodayHasTheDelaysOfItsControl) {
  const DesignResult result = design_task(parse_task(R"(
sample_period_ms = 1
[filter]
kind = "averages"
lengths = [40, 30]
[design]
family = "averages"
stages = 2
[controller]
delays = ["exact-stop"]
[[axis]]
acceleration_max_mm_s2 = 6000
jerk_max_mm_s3 = 500000
[[corner]]
angle_deg = 95
feed_in_mm_min = 6000
error_max_um = 50
)",
                                                     "task.toml"));
  ASSERT_TRUE(result.savings);
  EXPECT_DOUBLE_EQ(result.savings->today, 0.137);
  EXPECT_THAT(plot_result(result, "").title, testing::HasSubstr("137 ms"));
}

}  // namespace
}  // namespace accdec
