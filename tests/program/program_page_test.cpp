#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include <accdec/plot/program_page.hpp>
#include <accdec/program/write/profile_result.hpp>

#include "reference.hpp"

namespace accdec {
namespace {

using test::path_of;

ProfileResult planned(const std::string& text) {
  Task task;
  task.sample_period = 1e-3;
  Axis axis;
  axis.name = "all";
  axis.velocity_max = 0.2;
  axis.acceleration_max = 1.0;
  task.machine.axes = {axis};
  return run_profiles("test", path_of(text), task);
}

TEST(TimeLost, IsWhatTheMotionTakesBeyondWayOverFeed) {
  const double feed = 0.1;
  const ProfileResult result = planned("G64 P0.05 F6000\nG1 X30\nG1 Y30\nG1 X60 Y50\nM2\n");
  ASSERT_TRUE(result.plan.holds());
  double samples = 0.0, way = 0.0, x = 0.0, y = 0.0;
  visit_profile_samples(result, [&](std::int64_t k, const double* at, const double*) {
    way += std::hypot(at[0] - x, at[1] - y);
    x = at[0], y = at[1];
    samples = static_cast<double>(k);
  });
  const std::vector<CornerLoss> classes = time_lost(result.path, motion_of(result));
  double sum = 0.0;
  long joints = 0;
  for (const CornerLoss& loss : classes) {
    sum += loss.time;
    joints += loss.count;
    EXPECT_GE(loss.time, -1e-12);
  }
  EXPECT_EQ(joints, 3);
  EXPECT_NEAR(sum, samples * 1e-3 - way / feed, 1e-9);
  // Turns of 90 and 56.3 degrees, and the stop at the end.
  EXPECT_EQ(classes[4].count, 1);
  EXPECT_EQ(classes[3].count, 1);
  EXPECT_EQ(classes.back().count, 1);
  // Start and stop lose v/(2 a) each, a along the last leg by what its x has; a sample or two are rounding.
  const double along = 1.0 / (30.0 / std::hypot(30.0, 20.0));
  EXPECT_NEAR(classes.back().time, 0.5 * feed + 0.5 * feed / along, 2e-3);
}

}  // namespace
}  // namespace accdec
