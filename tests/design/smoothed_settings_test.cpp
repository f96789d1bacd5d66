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

// Settings in front of a control's own smoothing. Most members are refused by their taps behind it, before any motion
// is looked at.

namespace accdec {
namespace {

using accdec::testing::as_brute_force;
using accdec::testing::random_task;
using ::testing::IsEmpty;

/// One corner at about 100 mm/s under acceleration and jerk, and an undamped mode if asked for.
Task smoothed(std::mt19937& rng, SettingFamily family, bool rings) {
  std::uniform_real_distribution<double> u(0.0, 1.0);
  Task task = random_task(rng, 1);
  task.design.order_max = family == SettingFamily::shaper ? 18 : 30;
  const double period = task.sample_period, feed = task.corners.front().geometry().feed_in;
  task.corners.front().speed_min = 0.0, task.corners.front().error_max = (1.0 + 2.0 * u(rng)) * feed * period;
  for (Axis& axis : task.machine.axes) {
    // A boxcar of 8 to 16 taps, and a second average of 3 to 8.
    const double acceleration = feed / (period * (8.0 + 8.0 * u(rng)));
    axis = {.name = axis.name, .acceleration_max = acceleration};
    if (family != SettingFamily::exponential) axis.jerk_max = acceleration / (period * (3.0 + 5.0 * u(rng)));
  }
  Mode mode;
  mode.frequency_low = mode.frequency_high = (0.04 + 0.1 * u(rng)) / period;
  mode.residual_max = 0.05 + 0.25 * u(rng);
  if (rings) task.machine.modes.push_back(mode);
  const std::vector<double> third{0.25, 0.5, 0.25}, cubic{1.0 / 12.0, 5.0 / 12.0, 5.0 / 12.0, 1.0 / 12.0};
  task.machine.prefilter_taps = u(rng) < 0.5 ? third : cubic;
  ControllerSettings settings;
  settings.families = {family};
  settings.stages.resize(2);
  if (family == SettingFamily::shaper) settings.shaper = &shaper_list()[rng() % 4];
  settings.time_constant_step = period * (1.0 + 3.0 * u(rng));
  settings.alpha_step = 0.3 + u(rng);
  task.settings = settings;
  return task;
}

TEST(SmoothedSettings, AreTheBestOfAllByBruteForce) {
  constexpr SettingFamily families[] = {SettingFamily::averages, SettingFamily::shaper, SettingFamily::exponential,
                                        SettingFamily::gaussian};
  std::mt19937 rng(31);
  int found = 0;
  for (int i = 0; i < 32; ++i) {
    const std::string what = "task " + std::to_string(i);
    const Task task = smoothed(rng, families[i % 4], i % 3 == 0);
    const DesignResult result = as_brute_force(task, Status::optimal, Status::infeasible, what);
    EXPECT_THAT(verify_result(result).reasons, IsEmpty()) << what;
    found += result.has_design() ? 1 : 0;
  }
  EXPECT_GE(found, 12);
  EXPECT_LE(found, 28);
}

}  // namespace
}  // namespace accdec
