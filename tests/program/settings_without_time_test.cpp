#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <accdec/plan/feeds/control_delay.hpp>
#include <accdec/plan/filters/settings_for_program.hpp>
#include <accdec/plan/run/fixed_plan.hpp>
#include <accdec/program.hpp>
#include <accdec/simulate/simulate.hpp>

#include "corner_program.hpp"
#include "reference.hpp"
#include "support/paths.hpp"
#include "support/temporary_folder.hpp"

// Settings for a program when there is little time to plan them, and with more kinds of delays.

namespace accdec {
namespace {

Task star_task(std::vector<DelayKind> delays) {
  Task task = test::averages_task(2, std::move(delays));
  task.design.order_max = 400;
  for (Axis& axis : task.machine.axes) axis.jerk_max = 500.0;
  return task;
}

Toolpath star(const Task& task) {
  LineSource source(test_support::source_folder() + "/problems/program/star.ngc");
  Toolpath path = read_toolpath(source, task.machine, {});
  for (double& tolerance : path.tolerance) tolerance = 5e-5;
  return path;
}

/// The setting with which a start and a stop at the highest feed keep to their limits holds at every corner. At 100
/// mm/s that is v/a = 16.7 ms and a/j = 12 ms.
TEST(SettingsWithoutTime, AControlOfCornerFeedsGetsOneThatHolds) {
  const Task task = star_task({DelayKind::corner_feed});
  const Toolpath path = star(task);
  const std::optional<ProgramSettings> found = settings_for_program(path, task, false, Effort(0.0), {});
  ASSERT_TRUE(found);
  EXPECT_FALSE(found->complete);
  EXPECT_EQ(make_filter(found->chosen.filter).order() + 2, 17 + 12);
  Toolpath slow = path;
  slow.control = planned_control(task, found->width);
  const ProgramResult result = run_program({"star.ngc", slow, task, Feeds::choose}, make_filter(found->chosen.filter));
  EXPECT_TRUE(result.verification.feasible) << result.message;
  // Way over feed takes 62.3 s.
  EXPECT_LT(result.cycle_time, 1.2 * 62.4);
}

/// A rapid move is as fast as the filter lets it be, and asks for no longer filter.
TEST(SettingsWithoutTime, ARapidMoveChangesNothing) {
  const Task task = star_task({DelayKind::corner_feed});
  Toolpath path = star(task);
  path.rapid[0] = 1;
  path.duration[0] /= 5.0;
  const std::optional<ProgramSettings> found = settings_for_program(path, task, false, Effort(0.0), {});
  ASSERT_TRUE(found);
  EXPECT_EQ(make_filter(found->chosen.filter).order() + 2, 17 + 12);
}

/// All settings of one average, planned to the end. More kinds of delays begin with the answer of fewer.
TEST(SettingsWithoutTime, MoreKindsOfDelaysAreNoSlower) {
  const TemporaryFolder folder;
  const std::string program = folder.write("part.ngc", test::corner_program);
  const auto time = [&](std::vector<DelayKind> delays) {
    const Task task = test::averages_task(1, std::move(delays));
    const ProgramFileOptions options;
    ProgramFile file = read_program_file(program, task, options, {});
    const ProgramResult result = run_fixed_plan(file, task, options, {});
    EXPECT_TRUE(result.verification.feasible) << result.message;
    return result.cycle_time;
  };
  const double few = time({DelayKind::continuous}), stops = time({DelayKind::continuous, DelayKind::exact_stop});
  EXPECT_LE(time({DelayKind::continuous, DelayKind::in_position}), few * (1.0 + 1e-9));
  EXPECT_LE(time({DelayKind::continuous, DelayKind::exact_stop, DelayKind::in_position}), stops * (1.0 + 1e-9));
}

/// A control that only stops passes an arc without a stop at any chord. The feed keeps the tolerance: the error is
/// v^2 s^2 T^2/(2 R) with the second moment s^2 of the taps.
TEST(SettingsWithoutTime, AControlOfExactStopsLowersFeedsInsideArcs) {
  constexpr double radius = 0.01, tolerance = 1e-6, feed = 0.1, straight = 0.04;  // m, m/s
  const TemporaryFolder folder;
  const std::string program = folder.write("arc.ngc", "G21 G90 G64 P0.001 F6000\nG1 X20\nG3 X20 Y20 J10\nG1 X0\nM2\n");
  const Task task = test::averages_task(1, {DelayKind::continuous, DelayKind::exact_stop});
  ProgramFileOptions options;
  options.fixed.feeds = Feeds::keep;
  const ProgramResult result = run_fixed_plan(read_program_file(program, task, options, {}), task, options, {});
  ASSERT_TRUE(result.verification.feasible) << result.message;
  for (std::size_t b = 0; b + 1 < result.plan.path.blocks(); ++b) {
    if (result.plan.path.inside_arc[b] != 0) {
      EXPECT_EQ(result.plan.delay(b), 0) << b;
    }
  }
  const Filter& filter = result.plan.filter();
  double square = 0.0;  // s^2
  for (int i = 0; i <= filter.order(); ++i) square += filter.tap(i) * std::pow(i - filter.mean_delay(), 2);
  const double slow = std::sqrt(2.0 * radius * tolerance / square) / task.sample_period;
  // A boxcar starts and stops at the speed that its length and the limit of acceleration give.
  const double starts = 6.0 * (filter.order() + 1) * task.sample_period, fastest = std::min(feed, starts);
  const double arc = 3.141592653589793 * radius / std::min(fastest, slow);
  const double filters = 8.0 * (filter.order() + 1) * task.sample_period;  // of stops and steps of feed
  EXPECT_LT(result.cycle_time, straight / fastest + 1.1 * arc + filters);
}

}  // namespace
}  // namespace accdec
