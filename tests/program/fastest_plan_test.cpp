#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <variant>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <accdec/plan/run/fastest_plan.hpp>
#include <accdec/plan/run/fixed_plan.hpp>
#include <accdec/plan/trajectory/profile_repair.hpp>
#include <accdec/simulate/profile_motion.hpp>

#include "reference.hpp"
#include "support/paths.hpp"
#include "support/temporary_folder.hpp"
#include "support/tries.hpp"

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

/// The plan of one filter is a candidate of profiles.
void expect_ordered(const std::string& program, const Task& task) {
  ProgramFile file = read_program_file(program, task, {}, {});
  const ProgramResult fixed = run_fixed_plan(file, task, {}, {});
  ASSERT_TRUE(fixed.verification.feasible) << program;
  file = read_program_file(program, task, {}, {});
  const ProgramResult fastest = run_fastest_plan(file, task, {}, {});
  EXPECT_LE(fastest.cycle_time, fixed.cycle_time) << program;
  EXPECT_EQ(fastest.message, "") << program;
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

/// A machine whose limits and given filter, if any, make a case of their own.
struct FeedCase {
  const char* program;
  double acceleration;  // m/s^2
  double jerk;          // m/s^3
  int order;            // of a given boxcar; 0: a filter is designed
};

class ChosenFeeds : public ::testing::TestWithParam<FeedCase> {};

// Kept feeds are a candidate of chosen ones, with a given filter and with the filter designed for them.
TEST_P(ChosenFeeds, AreNeverSlowerThanKeptOnes) {
  const FeedCase& c = GetParam();
  Task task = task_of(c.jerk, c.order);
  for (Axis& axis : task.machine.axes) axis.velocity_max = 0.5, axis.acceleration_max = c.acceleration;
  if (c.order == 0) task.filter.reset();
  const std::string program = test_support::source_folder() + "/problems/program/" + c.program + ".ngc";
  const auto planned = [&](Feeds feeds) {
    ProgramFileOptions options;
    options.fixed.feeds = feeds;
    ProgramFile file = read_program_file(program, task, options, {});
    return run_fixed_plan(file, task, options, {});
  };
  const ProgramResult chosen = planned(Feeds::choose), kept = planned(Feeds::keep);
  ASSERT_TRUE(kept.verification.feasible) << kept.message;
  ASSERT_TRUE(chosen.verification.feasible) << chosen.message;
  EXPECT_LE(chosen.cycle_time, kept.cycle_time * (1.0 + 1e-12));
}

INSTANTIATE_TEST_SUITE_P(All, ChosenFeeds,
                         ::testing::Values(FeedCase{"raster", 1.0, unlimited, 99},
                                           FeedCase{"engraving", 1.0, unlimited, 99},
                                           FeedCase{"pocket", 1.0, unlimited, 60},
                                           FeedCase{"linuxcnc/corner-p0.1", 1.0, unlimited, 0},
                                           FeedCase{"linuxcnc/corner-p0.1", 6.0, unlimited, 0},
                                           FeedCase{"linuxcnc/corner-p0.1", 6.0, 500.0, 0},
                                           FeedCase{"linuxcnc/zigzag-p0.05", 1.0, unlimited, 0},
                                           FeedCase{"legs", 6.0, 500.0, 0}, FeedCase{"zigzag", 6.0, 500.0, 0}));

// Longer than what is planned in both ways in any case. At corners of all angles with legs of 10 mm, chosen feeds alone
// are slower than kept ones here, which no stretch of the program hides.
TEST(FastestPlan, LongProgramsAreNotSlowerThanAtKeptFeeds) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> heading(-std::numbers::pi, std::numbers::pi);
  std::string text = "G91 G64 P0.05\nF3000\n";
  for (std::size_t b = 0; b <= several_plans_max; ++b) {
    const double angle = heading(random);
    text += fmt::format("G1 X{:.6f} Y{:.6f}\n", 10.0 * std::cos(angle), 10.0 * std::sin(angle));
  }
  Task task = task_of(500.0, 40);
  for (Axis& axis : task.machine.axes) axis.velocity_max = 0.5, axis.acceleration_max = 6.0;
  const Toolpath path = test::path_of(text, task.machine);
  ASSERT_GT(path.blocks(), several_plans_max);
  const auto planned = [&](Feeds feeds) {
    const ProgramResult result = run_program({"long", path, task, feeds}, trapezoid(40, 10));
    EXPECT_TRUE(result.verification.feasible) << result.message;
    return result;
  };
  const ProgramResult kept = planned(Feeds::keep), chosen = planned(Feeds::choose);
  EXPECT_GT(planned(Feeds::choose_only).cycle_time, kept.cycle_time);
  EXPECT_EQ(chosen.cycle_time, kept.cycle_time);
  EXPECT_FALSE(chosen.feeds_chosen);
}

TEST(FastestPlan, OfRandomProgramsIsNoSlowerThanThoseItContains) {
  const TemporaryFolder folder;
  for (unsigned seed = 1; seed <= unsigned{test_support::tries(3)}; ++seed) {
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
