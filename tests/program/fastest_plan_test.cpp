#include <algorithm>
#include <cmath>
#include <string>
#include <variant>

#include <gtest/gtest.h>

#include <accdec/program/profiles/profile_motion.hpp>
#include <accdec/program/profiles/profile_repair.hpp>
#include <accdec/program/write/fastest_plan.hpp>

#include "reference.hpp"
#include "support/paths.hpp"
#include "support/temporary_folder.hpp"

namespace accdec {
namespace {

Task task_of(double jerk, int order) {
  Task task;
  task.sample_period = 1e-3;
  for (const char* name : {"x", "y", "z"}) {
    Axis axis;
    axis.name = name;
    axis.velocity_max = 0.2;
    axis.acceleration_max = 1.0;
    axis.jerk_max = jerk;
    task.machine.axes.push_back(axis);
  }
  // Given, so that no search ends by the clock.
  FilterSpec filter;
  filter.kind = jerk < unlimited ? Shape::trapezoid : Shape::boxcar;
  filter.order = order;
  filter.ramp = jerk < unlimited ? 20 : 0;
  task.filter = filter;
  return task;
}

/// Every plan is a candidate of the next: one filter, one a leg, profiles.
void expect_ordered(const std::string& program, const Task& task) {
  const auto planned = [&](bool per_leg) {
    ProgramFileOptions options;
    options.per_leg = per_leg;
    ProgramFile file = read_program_file(program, task, options, {});
    return run_program_file(program, file, task, options, {});
  };
  const ProgramResult fixed = planned(false), leg = planned(true);
  ASSERT_TRUE(fixed.verification.feasible && leg.verification.feasible) << program;
  EXPECT_LE(leg.cycle_time, fixed.cycle_time) << program;
  ProgramFile file = read_program_file(program, task, {}, {});
  const auto fastest = run_fastest_plan(program, file, task, {}, {});
  const double time = std::visit([](const auto& result) { return result.cycle_time; }, fastest);
  EXPECT_LE(time, leg.cycle_time) << program;
  if (const auto* profiles = std::get_if<ProfileResult>(&fastest)) {
    EXPECT_EQ(profiles->message, "") << program;
  }
}

class ShippedPrograms : public ::testing::TestWithParam<const char*> {};

TEST_P(ShippedPrograms, NoPlanIsSlowerThanThoseItContains) {
  const std::string program = test_support::source_folder() + "/problems/program/" + GetParam() + ".ngc";
  expect_ordered(program, task_of(unlimited, 15));
}

// All but raster and trochoid, which take ten seconds of processor time each.
INSTANTIATE_TEST_SUITE_P(All, ShippedPrograms,
                         ::testing::Values("pocket", "zigzag", "engraving", "star", "linuxcnc/zigzag-p0.05",
                                           "linuxcnc/corner-p0.1"));

TEST(FastestPlan, OfRandomProgramsIsNoSlowerThanThoseItContains) {
  const TemporaryFolder folder;
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const std::string text = test::random_program(seed, 60) + "G90 G64 P0.05\nG3 X5 Y5 R20\nG1 X0\nM2\n";
    expect_ordered(folder.write("random.ngc", text), task_of(seed % 2 == 0 ? 50.0 : unlimited, 45));
  }
}

TEST(ChainMaker, WhatIsMadeAgainMovesWhatFollowsByWholeSamples) {
  const Task task = task_of(50.0, 45);
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const Toolpath path = test::path_of(test::random_program(seed, 200) + "M2\n", task.machine);
    const Machine machine = program_machine(task.machine, path);
    const AvailableAcceleration available(machine, task.sample_period, LastFilter(21, task.sample_period));
    ProfileShares shares(path.blocks());
    ChainMaker maker(path, available);
    maker.make(shares);
    const auto drive = [&](std::vector<double>& phases) {
      ProfileMotion motion(path, maker.chain(), task.sample_period, available.last().filter());
      motion.note_phases(phases);
      std::int64_t samples = 0;
      while (motion.next()) ++samples;
      return samples;
    };
    std::vector<double> before(path.blocks()), after(path.blocks());
    const std::int64_t samples = drive(before);
    for (std::size_t place = 190; place < 210; ++place) shares.acceleration[place] = 0.6F;
    std::size_t first = 90, last = 110;
    while (!maker.remake(shares, first, last, before)) first -= std::min<std::size_t>(first, 5), last += 5;
    EXPECT_GT(drive(after), samples);
    ASSERT_LT(last + 1, path.blocks());
    for (std::size_t b = last + 1; b < path.blocks(); ++b) {
      const double moved = std::abs(after[b] - before[b]) / task.sample_period;
      ASSERT_LT(std::min(moved, std::abs(moved - 1.0)), 1e-7) << seed << " leg " << b;
    }
  }
}

}  // namespace
}  // namespace accdec
