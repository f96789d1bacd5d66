#include <cmath>
#include <numbers>
#include <optional>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <accdec/plan/free/free_motion.hpp>
#include <accdec/plan/report/axis_loads.hpp>
#include <accdec/plan/run/along_plan.hpp>
#include <accdec/plan/run/free_plan.hpp>
#include <accdec/plan/verify/own_trajectory.hpp>
#include <accdec/plan/verify/verify_program_result.hpp>
#include <accdec/program.hpp>

#include "../program/reference.hpp"

// Plans of positions whose distance from the moves is bounded.

namespace accdec {
namespace {

constexpr double half_ms = 5e-4;

Task task_of(std::optional<double> contour, double jerk) {
  Task task;
  task.sample_period = half_ms;
  task.machine = test::machine_of(2.0, jerk);
  task.program_contour_max = contour;
  // Given, so that no search ends by the clock.
  FilterSpec filter;
  filter.kind = Shape::trapezoid, filter.order = 240, filter.ramp = 70;
  task.filter = filter;
  return task;
}

ProgramFile file_of(const std::string& text, const Task& task, std::optional<double> error) {
  LineSource source("part.ngc", text);
  ToolpathOptions reading;
  reading.contour_max = task.program_contour_max.value_or(unlimited);
  reading.error_max = error;
  return {"part", read_toolpath(source, task.machine, reading)};
}

ProgramResult profiles_of(const std::string& text, const Task& task, std::optional<double> error) {
  const ProgramFile file = file_of(text, task, error);
  return run_profiles({file.name, file.path, task, Feeds::choose});
}

/// m, largest distance of points on the steps of a motion from the blocks, as its positions are written.
double contour(const ProgramResult& result) {
  const double unit = result.task_machine.position_unit;
  constexpr int parts = 8;
  double most = 0.0;
  Motion motion(result.plan, result.sample_period);
  Sample before, now;
  const auto written = [&](Sample& sample) {
    for (double& x : sample.position) x = unit > 0.0 ? std::round(x / unit) * unit : x;
  };
  motion.next(before);
  for (written(before); motion.next(now); before = now) {
    written(now);
    for (int i = 1; i <= parts; ++i) {
      const double t = static_cast<double>(i) / parts;
      const double x = before.position[0] + t * (now.position[0] - before.position[0]);
      const double y = before.position[1] + t * (now.position[1] - before.position[1]);
      most = std::max(most, test::from_blocks(result.plan.path, x, y));
    }
  }
  return most;
}

/// Corners of 90, about 23 and about 150 degrees, and an arc.
constexpr const char* part = "F6000\nG1 X20\nY20\nG1 X22 Y30\nX24 Y20\nX30 Y22\nG3 X40 Y32 J10\nG1 X40 Y50\nM2\n";

TEST(FreeContour, IsHeldAndUsedWithoutTolerances) {
  for (const double jerk : {unlimited, 60.0}) {
    SCOPED_TRACE(jerk);
    const Task task = task_of(2e-5, jerk);
    const ProgramFile file = file_of(part, task, {});
    const ProgramResult profiles = profiles_of(part, task, {});
    const ProgramResult free = run_free_plan(file, task, {}, {});
    for (const ProgramResult* result : {&profiles, &free}) {
      SCOPED_TRACE(result->plan.name());
      ASSERT_TRUE(result->verification.feasible) << result->message;
      EXPECT_LE(contour(*result), 2e-5 * (1.0 + 1e-9) + 1e-12);
      EXPECT_GE(contour(*result), 0.95 * 2e-5);
      EXPECT_THAT(verify_program_result(*result, task).reasons, testing::IsEmpty());
      EXPECT_FALSE(result->plan.path.tolerance[0] < unlimited) << "the program's own, not those it was planned with";
    }
    EXPECT_LT(free.cycle_time, profiles.cycle_time);
  }
}

/// A symmetric motion round a corner of a right angle is e sin(45 degrees) off the legs, for a corner error e.
TEST(FreeContour, OfARightAngleIsThatOfACornerError) {
  constexpr const char* corner = "F6000\nG1 X20\nY20\nM2\n";
  constexpr double most = 2e-5;
  const ProgramResult sides = profiles_of(corner, task_of(most, unlimited), {});
  const ProgramResult point = profiles_of(corner, task_of({}, unlimited), most * std::numbers::sqrt2);
  ASSERT_TRUE(sides.verification.feasible && point.verification.feasible);
  EXPECT_NEAR(sides.cycle_time, point.cycle_time, half_ms * (1.0 + 1e-9));
  // The narrower one of both counts.
  const ProgramResult both = profiles_of(corner, task_of(most, unlimited), most);
  const ProgramResult narrow = profiles_of(corner, task_of({}, unlimited), most);
  EXPECT_EQ(both.cycle_time, narrow.cycle_time);
  EXPECT_LT(point.cycle_time, narrow.cycle_time);
}

TEST(FreeContour, OfNothingStops) {
  const Task task = task_of(0.0, unlimited);
  const ProgramResult profiles = profiles_of(part, task, {});
  ASSERT_TRUE(profiles.verification.feasible) << profiles.message;
  EXPECT_LE(contour(profiles), 1e-12);
  EXPECT_THAT(verify_program_result(profiles, task).reasons, testing::IsEmpty());
}

TEST(FreeContour, IsRefusedWhereItIsBroken) {
  const Task task = task_of(2e-5, unlimited);
  ProgramResult profiles = profiles_of(part, task, {});
  ASSERT_TRUE(profiles.verification.feasible);
  profiles.plan.path.contour_max = 1.9e-5;
  EXPECT_THAT(verify_program_result(profiles, task).reasons, testing::Contains(testing::HasSubstr("contour")));
}

/// Legs of the same length in x at different feeds and slopes: the sample nearest to a corner is beside its block by
/// more than the contour. Each sample has to be given the block that it is near.
TEST(FreeContour, IsHeldByTheSamplesThatWindowsBeginWith) {
  std::string zigzag = "F6000\n";
  for (int i = 1; i <= 24; ++i)
    zigzag += "G1 X" + std::to_string(20 - 13 * (i % 2)) + " Y" + std::to_string(5 * i + i * i) + "\n";
  for (const double jerk : {unlimited, 500.0}) {
    SCOPED_TRACE(jerk);
    Task task = task_of(3e-5, jerk);
    task.sample_period = 1e-3;
    for (Axis& axis : task.machine.axes) axis.acceleration_max = 6.0;
    const ProgramResult profiles = profiles_of(zigzag, task, 5e-5);
    ASSERT_TRUE(profiles.verification.feasible) << profiles.message;
    const FreeSamples samples = sampled(profiles.plan.path, *profiles.plan.trajectory(), profiles.sample_period);
    ProgramResult begun = with_samples(profiles, samples);
    EXPECT_EQ(judge_trajectory(begun, task.machine), "");
    EXPECT_EQ(begun.cycle_time, profiles.cycle_time);
    EXPECT_LE(contour(begun), 3e-5 * (1.0 + 1e-9) + 1e-12);
  }
}

/// Rounding to whole numbers of a unit moves a position by up to half a diagonal of the grid.
TEST(FreeContour, IsHeldByWholeNumbersOfAUnit) {
  constexpr double contours = 2e-5;
  constexpr const char* corners = "F6000\nG1 X4\nY4\nG1 X5 Y8\nX6 Y4\nM2\n";
  for (const double unit : {2e-5, 5e-6}) {
    SCOPED_TRACE(unit);
    Task task = task_of(contours, 500.0);
    task.machine.position_unit = unit;
    const ProgramFile file = file_of(corners, task, {});
    EXPECT_NEAR(file.path.contour_max, contours - unit / std::numbers::sqrt2, 1e-15);
    const ProgramResult profiles = run_profiles({file.name, file.path, task, Feeds::choose});
    const ProgramResult free = run_free_plan(file, task, {}, {});
    for (const ProgramResult* result : {&profiles, &free}) {
      SCOPED_TRACE(result->plan.name());
      ASSERT_TRUE(result->verification.feasible) << result->message;
      EXPECT_EQ(result->task_machine.position_unit, unit);
      EXPECT_LE(contour(*result), contours * (1.0 + 1e-9) + 1e-12);
    }
  }
  Task coarse = task_of(contours, unlimited);
  coarse.machine.position_unit = 3e-5;  // half a diagonal is 21.2 um
  try {
    file_of(corners, coarse, {});
    FAIL() << "nothing is left of the contour";
  } catch (const std::exception& e) {
    EXPECT_THAT(e.what(),
                testing::AllOf(testing::HasSubstr("part.ngc:"), testing::HasSubstr("contour_max_um = 20"),
                               testing::HasSubstr("position_unit_um = 30"), testing::HasSubstr("up to 21.21 um")));
  }
}

/// A leg of 40 mm from rest to rest at 0.2 m/s with 2 m/s^2: ramps of n = 200 samples. Samples of a constant
/// acceleration a have second differences a, and a/2 at both ends. The squares of a ramp are those of n - 1/2 samples.
TEST(FreeContour, RatingsAreThoseOfAClosedForm) {
  Task task = task_of({}, unlimited);
  for (Axis& axis : task.machine.axes) axis.mass = 30.0;
  const ProgramResult leg = profiles_of("F12000\nG1 X40\nM2\n", task, 1e-5);
  ASSERT_TRUE(leg.verification.feasible);
  const double force = 30.0 * 2.0, ramp = 200.0, samples = static_cast<double>(leg.check.samples);
  const double rms = force * std::sqrt(2.0 * (ramp - 0.5) / samples);
  const Machine machine = program_machine(task.machine, leg.plan.path);
  const OwnTrajectory own = own_trajectory(leg.plan, half_ms, machine);
  EXPECT_NEAR(own.rms[0], rms, 1e-7 * rms);
  EXPECT_NEAR(axis_loads(leg, machine)[0].rms, rms, 1e-7 * rms);
}

}  // namespace
}  // namespace accdec
