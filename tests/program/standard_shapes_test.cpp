#include <cmath>
#include <optional>
#include <string>

#include <gtest/gtest.h>

#include <accdec/filter.hpp>
#include <accdec/plan/run/fixed_plan.hpp>
#include <accdec/program.hpp>

#include "reference.hpp"
#include "support/temporary_folder.hpp"

// Filters of programs with limits that their design knows in part: against scans of filters that are given.

namespace accdec {
namespace {

Task viscous_task() {
  Task task;
  task.machine = test::machine_of(unlimited, unlimited, 0.5, 2);
  for (Axis& axis : task.machine.axes) axis.mass = 34.0, axis.damping = 840.0, axis.force_max = 465.0;
  return task;
}

ProgramResult zigzag_with(const Task& task, const std::optional<FilterSpec>& filter) {
  const TemporaryFolder folder;
  const std::string program =
      folder.write("zigzag.ngc", "G21 G90 G64 P0.15\nG1 X35 Y35 F20000\nX0 Y70\nX35 Y105\nX0 Y140\nM2\n");
  Task with = task;
  with.filter = filter;
  return run_fixed_plan(read_program_file(program, with, {}, {}), with, {}, {});
}

/// The design is at most 1 % slower than the fastest of these.
void expect_no_slower_than_given(const Task& task) {
  const ProgramResult designed = zigzag_with(task, {});
  ASSERT_TRUE(designed.verification.feasible) << designed.message;
  for (const Shape shape : {Shape::hann, Shape::boxcar}) {
    for (const int order : {10, 20, 40, 80, 120, 200}) {
      const ProgramResult given = zigzag_with(task, FilterSpec{shape, order});
      if (!given.verification.feasible) continue;
      EXPECT_LE(designed.cycle_time, 1.01 * given.cycle_time) << to_string(shape) << " of order " << order;
    }
  }
}

TEST(StandardShapes, AreNoSlowerThanGivenFiltersUnderARating) {
  for (const double rating : {200.0, 100.0}) {
    Task task = viscous_task();
    task.machine.axes[0].force_rms_max = rating;
    expect_no_slower_than_given(task);
  }
}

Task lagging_task() {
  Task task = viscous_task();
  task.program_contour_max = 3e-5;
  task.machine.axes[0].servo_gain = 100.0;
  task.machine.axes[1].servo_gain = 60.0, task.machine.axes[1].velocity_feedforward = 0.5;
  return task;
}

TEST(StandardShapes, AreNoSlowerThanGivenFiltersBehindServosThatDiffer) {
  expect_no_slower_than_given(lagging_task());
}

/// At constant feed v on a leg at 45 degrees, axes that lag by s and t are v |s - t|/2 off its line. The contour
/// allows that feed. Begun at rest, x lags by (1 - e^(-t/10 ms)) 10 ms and y by (1 - e^(-60 t)) 0.5/60 s. They
/// are apart most where e^(-100 t) = e^(-60 t)/2, at t = 17.3 ms, by 1.71 times as much. No filter makes that worse,
/// and corners cost less than that again: no plan needs three times the time of the legs at constant feed.
TEST(StandardShapes, LegsBehindServosThatDifferKeepMostOfTheirFeed) {
  const Task task = lagging_task();
  const double lags = 1.0 / 100.0 - 0.5 / 60.0, feed = 2.0 * *task.program_contour_max / lags;
  const double legs = 4.0 * std::hypot(0.035, 0.035) / feed;
  for (const int order : {80, 95, 200}) {
    const ProgramResult result = zigzag_with(task, FilterSpec{Shape::hann, order});
    ASSERT_TRUE(result.verification.feasible) << result.message;
    EXPECT_LE(result.cycle_time, 3.0 * legs) << order;
    EXPECT_GE(result.cycle_time, legs) << order;
  }
}

}  // namespace
}  // namespace accdec
