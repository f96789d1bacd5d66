#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <accdec/design.hpp>
#include <accdec/result.hpp>
#include <accdec/task.hpp>
#include <accdec/verify.hpp>

#include "settings_brute_force.hpp"
#include "support/tasks.hpp"

// Settings of controllers behind servos that overshoot and under modes of axes: every delay is tried, nothing is
// proved, and brute force finds none that is faster.

namespace accdec {
namespace {

using accdec::testing::as_brute_force;
using accdec::testing::random_task;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// @return whether there is a setting
bool is_as_brute_force(const Task& task, const std::string& what) {
  const DesignResult result = as_brute_force(task, Status::feasible, Status::failed, what);
  if (result.has_design()) {
    EXPECT_THAT(verify_result(result).reasons, IsEmpty()) << what;
  }
  EXPECT_THAT(result.message, HasSubstr("not proved best")) << what;
  EXPECT_FALSE(result.family_bound) << what;
  return result.has_design();
}

Task averages(std::mt19937& rng, std::vector<DelayKind> delays, int corners) {
  Task task = random_task(rng, corners);
  task.design.order_max = 20;
  ControllerSettings settings;
  settings.families = {SettingFamily::averages};
  settings.stages.resize(2);
  settings.delays = std::move(delays);
  task.settings = settings;
  for (TaskCorner& corner : task.corners) corner.error_max = 4.0 * *corner.error_max, corner.speed_min *= 0.2;
  for (Axis& axis : task.machine.axes) {
    axis.power_max *= 2.0, axis.regeneration_max *= 2.0, axis.force_max *= 1.5;
    axis.acceleration_max *= 2.0, axis.jerk_max *= 2.0;
  }
  return task;
}

const std::vector<std::vector<DelayKind>> kinds{
    {}, {DelayKind::exact_stop}, {DelayKind::in_position}, {DelayKind::continuous, DelayKind::in_position}};

TEST(UnprovedSettings, BehindAnOvershootAreTheBestOfAllByBruteForce) {
  std::mt19937 rng(41);
  std::uniform_real_distribution<double> u(0.0, 1.0);
  int feasible = 0;
  for (int i = 0; i < 8; ++i) {
    Task task = averages(rng, kinds[static_cast<std::size_t>(i) % 4], 1 + i % 2);
    const double first = 0.2 + 0.5 * u(rng), over = 0.05 + 0.2 * u(rng), back = 0.05 * u(rng);
    for (Axis& axis : task.machine.axes) axis.response_taps = {first, 1.0 - first + over - back, -over, back};
    task.settings->in_position_actual = i % 3 != 2;
    feasible += is_as_brute_force(task, "task " + std::to_string(i)) ? 1 : 0;
  }
  EXPECT_GE(feasible, 3);
}

TEST(UnprovedSettings, UnderAModeOfAnAxisAreTheBestOfAllByBruteForce) {
  std::mt19937 rng(42);
  std::uniform_real_distribution<double> u(0.0, 1.0);
  int feasible = 0;
  for (int i = 0; i < 8; ++i) {
    Task task = averages(rng, kinds[static_cast<std::size_t>(i) % 4], 1 + i % 2);
    Mode mode;
    mode.axis = i % 2;
    mode.residual_max = 1.0;
    mode.frequency_low = mode.frequency_high = (0.03 + 0.1 * u(rng)) / task.sample_period;
    mode.damping_low = mode.damping_high = 0.1 * u(rng);
    const double w = 2.0 * std::numbers::pi * mode.frequency_low;
    mode.displacement_max = (0.05 + 0.4 * u(rng)) * task.corners.front().geometry().feed_in / w;
    task.machine.modes.push_back(mode);
    if (i % 3 == 0) task.machine.prefilter_taps = {0.5, 0.5};
    feasible += is_as_brute_force(task, "task " + std::to_string(i)) ? 1 : 0;
  }
  EXPECT_GE(feasible, 3);
}

/// The steps of a corner feed swing together, which no formula here adds up.
TEST(UnprovedSettings, CornerFeedsRefuseAModeOfAnAxis) {
  const std::string text =
      "sample_period_ms = 1\n[design]\nfamily = \"averages\"\n[controller]\ndelays = [\"corner-feed\"]\n"
      "[[axis]]\nname = \"x\"\n[[axis]]\nname = \"y\"\n[[mode]]\nfrequency_Hz = 40\naxis = \"x\"\n"
      "residual_max_um = 5\n[[corner]]\nangle_deg = 90\nfeed_in_mm_min = 6000\n";
  try {
    parse_task(text, "task.toml");
    ADD_FAILURE();
  } catch (const std::exception& error) {
    EXPECT_THAT(error.what(), HasSubstr("task.toml:13:"));
    EXPECT_THAT(error.what(), HasSubstr("leave \"corner-feed\" out of `delays`"));
  }
}

}  // namespace
}  // namespace accdec
