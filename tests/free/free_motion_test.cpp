#include <atomic>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <accdec/bounds/any_motion_bound.hpp>
#include <accdec/plan/run/free_plan.hpp>
#include <accdec/plan/verify/verify_program_result.hpp>
#include <accdec/simulate/tube_check.hpp>

#include "../program/free_corner.hpp"
#include "../program/reference.hpp"
#include "support/temporary_folder.hpp"
#include "support/tries.hpp"

namespace accdec {
namespace {

using test::machine_of;
using testing::HasSubstr;

ProgramFile file_of(const std::string& program, const Task& task) {
  return {"test", test::path_of(program, task.machine)};
}

Task task_of(double period, double jerk) {
  Task task;
  task.sample_period = period;
  task.machine = machine_of(1.0, jerk, 0.2, 3);
  return task;
}

ProgramResult free_plan(const std::string& program, const Task& task, const ProgramFileOptions& options = {}) {
  return run_free_plan(file_of(program, task), task, options, {});
}

/// The plan holds for the check of results, which makes everything from the recorded samples again.
void expect_holds(const ProgramResult& result, const Task& task) {
  EXPECT_TRUE(result.verification.feasible) << result.message;
  EXPECT_THAT(verify_program_result(result, task).reasons, testing::IsEmpty());
}

// Clp solves a linear program over all samples. It passes the corner in its middle and stays within polygons
// inscribed in tube and discs, so the free motion may be shorter. No motion is shorter than the bound. A window that
// slides from a local beginning may end two samples above the optimum.
TEST(FreeMotion, OfOneCornerIsTheOptimumOfALinearProgramme) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  constexpr double T = 4e-3;
  for (int i = 0; i < test_support::tries(6); ++i) {
    const Task task = task_of(T, i % 3 == 2 ? 30.0 : unlimited);
    const test::FreeCorner corner(2.0 * std::numbers::pi * unit(random), 0.3 + 2.0 * unit(random), 0.012,
                                  i % 2 == 0 ? 5e-4 : 5e-5, 0.1, task.machine.axes[0], T);
    const ProgramResult result = free_plan(corner.program(), task);
    expect_holds(result, task);
    EXPECT_LE(result.cycle_time, corner.least_time(60, 160) + 2.5 * T) << corner.program();
    const Toolpath path = test::path_of(corner.program(), task.machine);
    EXPECT_GE(result.cycle_time, any_motion_bound(path, task.machine, T, Deadline(60.0)).time) << corner.program();
  }
}

TEST(FreeMotion, OfRandomProgramsHoldsAndIsNotSlowerThanOtherPlans) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int i = 0; i < test_support::tries(8); ++i) {
    Task task = task_of(2e-3, i % 2 == 0 ? unlimited : 40.0);
    if (i % 3 == 0) {
      for (Axis& axis : task.machine.axes) {
        axis.mass = 2.0;
        axis.damping = 5.0;
        axis.force_max = 1.8;
      }
    }
    std::string program = "G64 P0.05 F5000\n";
    const double size = i % 4 < 2 ? 12.0 : 1.5;
    for (int k = 0; k < 12; ++k) {
      if (k == 5) program += i % 2 == 0 ? "G61.1\n" : "G4 P0.03\n";
      if (k == 6) program += "G64 P0.2 F3000\n";
      program += fmt::format("G1 X{:.4f} Y{:.4f} Z{:.4f}\n", size * unit(random), size * unit(random),
                             0.3 * size * unit(random));
    }
    const ProgramResult result = free_plan(program + "M2\n", task);
    expect_holds(result, task);
    EXPECT_STREQ(result.plan.name(), "free") << result.message << program;
    ASSERT_FALSE(result.candidates.empty()) << program;
    for (const PlanTime& other : result.candidates) EXPECT_LE(result.cycle_time, other.time) << other.plan << program;
  }
}

const char* const zigzag =
    "G64 P0.2 F6000\nG1 X20\nY2\nX0\nY4\nX20\nY6\nX0\nY8\nX20\nY10\nX0\nY12\nX20\nY14\nX0\nY16\nX20\nM2\n";

TEST(FreeMotion, HoldsWheneverItEnds) {
  const Task task = task_of(1e-3, 50.0);
  const double whole = free_plan(zigzag, task).cycle_time;
  for (const int last : {0, 1}) {
    std::atomic<bool> cancel = last == 0;
    ProgramFileOptions options;
    options.deadline.end_when(cancel);
    options.free.progress = [&](const FreeProgress& at) { cancel = cancel || at.share > 0.0; };
    const ProgramResult result = free_plan(zigzag, task, options);
    expect_holds(result, task);
    EXPECT_GE(result.cycle_time, whole);
    if (last > 0) {  // else there is time for the first plan alone
      ASSERT_FALSE(result.candidates.empty());
    }
    for (const PlanTime& other : result.candidates) EXPECT_LE(result.cycle_time, other.time) << other.plan;
  }
  for (const double seconds : {1e-3, 0.05}) {
    ProgramFileOptions options;
    options.deadline = Deadline(seconds);
    const ProgramResult result = free_plan(zigzag, task, options);
    if (result.verification.feasible) expect_holds(result, task);
  }
}

TEST(FreeMotion, DoesNotDependOnThreads) {
  const Task task = task_of(1e-3, unlimited);
  ProgramFileOptions two;
  two.free.threads = 2;
  EXPECT_EQ(free_plan(zigzag, task).cycle_time, free_plan(zigzag, task, two).cycle_time);
}

TEST(FreeMotion, RefusesByNameWhatItDoesNotKeep) {
  const auto refusal = [&](const Task& task, const ProgramFileOptions& options) -> std::string {
    try {
      free_plan(zigzag, task, options);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  Task task = task_of(1e-3, unlimited);
  task.machine.modes.push_back({30.0, 40.0, 0.1});
  EXPECT_THAT(refusal(task, {}), HasSubstr("vibration"));
  task = task_of(1e-3, unlimited);
  task.machine.axes[1].power_max = 10.0;
  EXPECT_THAT(refusal(task, {}), HasSubstr("power"));
  task = task_of(1e-3, unlimited);
  task.machine.axes[1].regeneration_max = 10.0;
  EXPECT_THAT(refusal(task, {}), HasSubstr("regeneration"));
  task = task_of(1e-3, unlimited);
  task.machine.axes[0].acceleration_max = unlimited;
  EXPECT_THAT(refusal(task, {}), HasSubstr("acceleration"));
  ProgramFileOptions options;
  options.fixed.feeds = Feeds::keep;
  EXPECT_THAT(refusal(task_of(1e-3, unlimited), options), HasSubstr("only plan fixed keeps feeds"));
}

// One fault each in a motion that holds.
TEST(TubeCheck, FindsEveryFault) {
  const Machine machine = machine_of(1.0);
  const Toolpath path = test::path_of("G64 P0.1 F6000\nG1 X10\nG61.1\nG1 Y10\nG4 P0.002\nG1 X0\nM2\n", machine);
  constexpr double T = 1e-3;
  // Along the legs at 50 mm/s, with a rest of two samples in (10, 10).
  std::vector<std::array<double, 2>> points;
  std::vector<std::size_t> block;
  const auto add = [&](double x, double y, std::size_t b) {
    points.push_back({x, y});
    block.push_back(b);
  };
  for (int k = 1; k <= 200; ++k) add(k * 5e-5, 0.0, 0);
  for (int k = 1; k <= 200; ++k) add(0.01, k * 5e-5, 1);
  for (int k = 0; k < 2; ++k) add(0.01, 0.01, 1);
  for (int k = 1; k <= 200; ++k) add(0.01 - k * 5e-5, 0.01, 2);
  const auto check = [&](const auto& change) {
    auto at = points;
    auto along = block;
    change(at, along);
    TubeCheck tube(path, T);
    for (std::size_t k = 0; k < at.size(); ++k) tube.look(at[k].data(), along[k]);
    return tube.finish();
  };
  EXPECT_EQ(check([](auto&, auto&) {}), "");
  EXPECT_EQ(check([](auto& at, auto&) { at[100][1] = 8e-5; }), "");
  EXPECT_THAT(check([](auto& at, auto&) { at[100][1] = 1.01e-4; }), HasSubstr("off its leg"));
  EXPECT_THAT(check([](auto&, auto& along) { along[100] = 1; }), HasSubstr("off its leg"));
  EXPECT_THAT(check([](auto& at, auto&) { at[100][0] += 6e-5; }), HasSubstr("programmed are 100"));
  EXPECT_THAT(check([](auto& at, auto&) { at[400][0] -= 1e-8; }), HasSubstr("rest"));
  EXPECT_THAT(check([](auto& at, auto&) { at.back()[0] = 1e-7; }), HasSubstr("does not end"));
}

}  // namespace
}  // namespace accdec
