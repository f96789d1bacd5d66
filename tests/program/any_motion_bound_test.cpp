#include <cmath>
#include <numbers>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <accdec/bounds/any_motion_bound.hpp>
#include <accdec/bounds/corner_bound.hpp>
#include <accdec/bounds/filter_bound.hpp>
#include <accdec/bounds/lower_bound.hpp>
#include <accdec/plan/trajectory/plan_profiles.hpp>

#include "free_corner.hpp"
#include "reference.hpp"
#include "support/paths.hpp"

namespace accdec {
namespace {

using test::FreeCorner;
using test::machine_of;

double bound_of(const std::string& program, const Machine& m, double period) {
  return any_motion_bound(test::path_of(program, m), m, period, Deadline(60.0)).time;
}

TEST(AnyMotionBound, IsNotAboveTheFastestFreeMotionAndCloseToIt) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  constexpr double T = 4e-3;
  for (int i = 0; i < 6; ++i) {
    const Machine m = machine_of(1.0, i % 3 == 2 ? 30.0 : unlimited);
    const FreeCorner corner(2.0 * std::numbers::pi * unit(random), (0.3 + 2.4 * unit(random)), 0.012,
                            i % 2 == 0 ? 5e-4 : 5e-5, 0.1, m.axes[0], T);
    const double free = corner.least_time(60, 160), bound = bound_of(corner.program(), m, T);
    EXPECT_LE(bound, free + 1e-9) << i;
    // The motion has to pass the corner in its middle, on a sample, and inside polygons; the bound takes periods off.
    EXPECT_GE(bound, 0.94 * free) << i;
  }
}

// Free motions that another program found, with HiGHS: 50 mm to the corner and 50 mm away, 1.129 s and 1.176 s, 1.146
// s with a jerk limit. Plans that are sums of monotone legs take 1.143 s, 1.179 s and 1.161 s at least.
TEST(AnyMotionBound, LiesBelowFreeMotionsThatMonotoneLegsDoNotReach) {
  const auto program = [](const char* tolerance) {
    return fmt::format("G64 P{} F6000\nG1 X50\nG1 Y50\nM2\n", tolerance);
  };
  const auto check = [&](const char* tolerance, double jerk, double free) {
    const Machine m = machine_of(1.0, jerk);
    const double bound = bound_of(program(tolerance), m, 1e-3);
    EXPECT_LE(bound, free) << tolerance;
    EXPECT_GE(bound, 0.985 * free) << tolerance;
    EXPECT_GT(program_corner_bound(test::path_of(program(tolerance), m), m, 1e-3, Deadline(60.0)).time, free);
  };
  check("0.5", unlimited, 1.129);
  check("0.05", unlimited, 1.176);
  check("0.5", 50.0, 1.146);
}

TEST(AnyMotionBound, OfAStraightLineIsTheClosedForm) {
  // From rest to rest along an axis and a diagonal: L/F + F/a. The tube lets a motion along 30 degrees speed up by more
  // than its direction allows, so there the bound is lower; it stays above the way over feed.
  const Machine m = machine_of(1.0);
  constexpr double T = 1e-6;
  EXPECT_NEAR(bound_of("G61.1 F6000\nG1 X50\nM2\n", m, T), 0.6, 2e-3);
  EXPECT_LE(bound_of("G61.1 F6000\nG1 X50\nM2\n", m, T), 0.6);
  const double diagonal = 0.05 * std::numbers::sqrt2 / 0.1 + 0.1 / std::numbers::sqrt2;
  EXPECT_NEAR(bound_of("G61.1 F6000\nG1 X50 Y50\nM2\n", m, T), diagonal, 2e-3);
  EXPECT_LE(bound_of("G61.1 F6000\nG1 X50 Y50\nM2\n", m, T), diagonal + 1e-9);
}

// A program need not move all axes of the machine, nor in their order.
TEST(Bounds, FindTheAxesOfTheProgramByTheirNames) {
  Machine m = machine_of(1.0);
  std::swap(m.axes[0], m.axes[1]);
  m.axes[0].acceleration_max = 1000.0;  // of y
  constexpr double T = 1e-6, closed = 0.6;
  const Toolpath path = test::path_of("G61.1 F6000\nG1 X50\nM2\n", m);
  const double points = program_lower_bound(path, m, T), any_motion = any_motion_bound(path, m, T, Deadline(60.0)).time,
               corners = program_corner_bound(path, m, T, Deadline(60.0)).time;
  for (const double bound : {points, any_motion, corners}) {
    EXPECT_NEAR(bound, closed, 2e-3);
    EXPECT_LE(bound, closed);
  }
  // A filter slows the feed down in as many taps as 1/(a T/F); the command takes L/F.
  EXPECT_NEAR(filter_lower_bound(path, m, T).value(), closed, 1e-5);
}

TEST(AnyMotionBound, SaysWhetherItWasFinished) {
  const Machine m = machine_of(1.0, 50.0);
  const Toolpath path = test::path_of("G64 P0.05 F6000\nG1 X50\nG1 Y50\nM2\n", m);
  const AnyMotionBound finished = any_motion_bound(path, m, 1e-3, Deadline(60.0)),
                       cut = any_motion_bound(path, m, 1e-3, Deadline(0.0));
  EXPECT_TRUE(finished.complete);
  EXPECT_FALSE(cut.complete);
  EXPECT_LT(cut.time, finished.time);
  EXPECT_GE(cut.time, program_lower_bound(path, m, 1e-3));
}

// A motion that keeps a jerk limit is one without it, and one that stops at a joint passes it.
TEST(Bounds, OfMoreLimitsAndStricterPathsAreNotLower) {
  constexpr double period = 1e-3;
  std::string zigzag = "F6000\n";
  for (int i = 1; i <= 12; ++i) zigzag += fmt::format("G1 X{} Y{}\n", 4 * i, i % 2 == 0 ? 0 : 3);
  zigzag += "M2\n";
  const Machine free = machine_of(1.0);
  for (const double jerk : {20.0, 50.0, 1e4}) {
    const Machine bounded = machine_of(1.0, jerk);
    const Toolpath path = test::path_of("G64 P0.5 " + zigzag, free);
    EXPECT_GE(any_motion_bound(path, bounded, period, Deadline(60.0), false).time,
              any_motion_bound(path, free, period, Deadline(60.0), false).time);
    EXPECT_GE(program_corner_bound(path, bounded, period, Deadline(60.0)).time,
              program_corner_bound(path, free, period, Deadline(60.0)).time);
    EXPECT_GE(bound_of("G61.1 " + zigzag, bounded, period), bound_of("G61 " + zigzag, bounded, period));
  }
}

// Long legs gain by their jerk limit, fine chords by leaving it out.
TEST(AnyMotionBound, TakesTheLargerBoundSectionBySection) {
  const Machine bounded = machine_of(1.0, 50.0), free = machine_of(1.0);
  std::string legs = "G1 X30\nG1 Y30\n", chords;
  for (int i = 1; i <= 60; ++i) chords += fmt::format("G1 X{:.4f} Y{:.4f}\n", 30 + 0.3 * i, i % 2 == 0 ? 30.0 : 30.05);
  const std::string head = "G64 P0.05 F6000\n", stop = "G4 P0.1\n";
  const auto bound = [&](const std::string& text, const Machine& m) { return bound_of(head + text + "M2\n", m, 1e-3); };
  const std::string there = "G0 X30 Y30\n" + stop;
  const double both = bound(legs + stop + chords, bounded);
  // The way there, its dwell and two sections of two periods each are counted apart.
  const double apart = bound(legs, bounded) + bound(there + chords, bounded) - bound(there, bounded) + 0.1;
  EXPECT_GE(both, apart - 4e-3);
  EXPECT_GE(both, bound(legs + stop + chords, free) - 1e-9);
}

TEST(AnyMotionBound, IsNotAbovePlansOfRandomPrograms) {
  std::mt19937 random(21);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  double sum = 0.0, points = 0.0, plans = 0.0;
  for (int i = 0; i < 12; ++i) {
    const Machine m = machine_of(i % 4 < 2 ? 0.5 : 2.0, i % 2 == 0 ? 50.0 : unlimited);
    std::string text = fmt::format("G91 G64 P{} F6000\n", i % 3 == 0 ? 0.3 : 0.03);
    const double shortest = i % 5 == 0 ? 1.0 : 8.0;
    for (int b = 0; b < 8; ++b) {
      const double angle = 2.0 * std::numbers::pi * unit(random), length = shortest + 9.0 * unit(random);
      text += fmt::format("G{} X{:.6f} Y{:.6f}{}\n", unit(random) < 0.1 ? 0 : 1, length * std::cos(angle),
                          length * std::sin(angle), unit(random) < 0.2 ? " F3000" : " F6000");
      if (unit(random) < 0.05) text += "G4 P0.1\n";
    }
    const Toolpath path = test::path_of(text + "M2\n", m);
    const double bound = any_motion_bound(path, m, 1e-3, Deadline(5.0)).time;
    const ProfilePlan plan = plan_profiles(path, m, 1e-3);
    ASSERT_TRUE(plan.holds()) << text;
    const double time = static_cast<double>(plan.check.samples) * 1e-3;
    EXPECT_LE(bound, time * (1.0 + 1e-8)) << text;
    sum += bound;
    points += program_lower_bound(path, m, 1e-3);
    plans += time;
  }
  EXPECT_GE(sum, points);
  EXPECT_GE(sum, 0.75 * plans);
}

}  // namespace
}  // namespace accdec
