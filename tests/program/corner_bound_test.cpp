#include <cmath>
#include <numbers>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <accdec/bounds/corner_bound.hpp>
#include <accdec/bounds/lower_bound.hpp>
#include <accdec/plan/trajectory/plan_profiles.hpp>

#include "reference.hpp"
#include "support/paths.hpp"
#include "support/tries.hpp"

namespace accdec {
namespace {

using test::machine_of;

/// Two legs of 50 mm at F = 100 mm/s, the first at `heading`, turning by `turn` degrees.
std::string corner(double heading, double turn, double tolerance) {
  const double a = heading * std::numbers::pi / 180.0, b = a + turn * std::numbers::pi / 180.0;
  const double x = 50.0 * std::cos(a), y = 50.0 * std::sin(a);
  return fmt::format("G64 P{} F6000\nG1 X{:.9f} Y{:.9f}\nG1 X{:.9f} Y{:.9f}\nM2\n", tolerance, x, y,
                     x + 50.0 * std::cos(b), y + 50.0 * std::sin(b));
}

TEST(CornerBound, OfARightAngleAlongTheAxesIsWhatTheParabolaLoses) {
  // There the parabola is the optimum of the linear program: v_c^2 = 8 a e/sqrt(2), (F - v_c)^2/(a F) + (1 - v_c/F)
  // v_c/a lost. Periods of 1 ms and the polygon around the tolerance relax it a little.
  const double a = 1.0, F = 0.1, e = 5e-5, v = std::sqrt(8.0 * a * e / std::numbers::sqrt2);
  const double lost = (F - v) * (F - v) / (a * F) + (1.0 - v / F) * v / a;
  const double in[] = {1.0, 0.0}, out[] = {0.0, 1.0};
  const BoundCorner right{in, out, F, F, F, 0.12, 0.12, e};
  const double bound = corner_loss(right, machine_of(a), 2, 240).at();
  EXPECT_LE(bound, lost * (1.0 + 1e-9));
  EXPECT_GE(bound, lost - 5e-4);
}

TEST(CornerBound, NoToleranceCostsAStop) {
  // Straight back: from F to rest and to F, 2 F/a of which half is lost.
  const double in[] = {1.0, 0.0}, out[] = {-1.0, 0.0};
  const BoundCorner back{in, out, 0.1, 0.1, 0.1, 0.12, 0.12, 0.0};
  const double bound = corner_loss(back, machine_of(1.0), 2, 240).at();
  EXPECT_LE(bound, 0.1 + 1e-9);
  EXPECT_GE(bound, 0.099);
}

TEST(CornerBound, IsNotAbovePlansOfLongLegs) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int i = 0; i < 12; ++i) {
    const double jerk = i % 3 == 0 ? 50.0 : unlimited;
    const Machine m = machine_of(1.0, jerk);
    const Toolpath path =
        test::path_of(corner(360.0 * unit(random), 5.0 + 170.0 * unit(random), 0.01 + 0.2 * unit(random)), m);
    const CornerBound bound = program_corner_bound(path, m, 1e-3, Deadline(60.0));
    const ProfilePlan plan = plan_profiles(path, m, 1e-3);
    ASSERT_TRUE(plan.holds());
    EXPECT_EQ(bound.counted, 1U);
    const double time = static_cast<double>(plan.check.samples) * 1e-3;
    EXPECT_LE(bound.time, time + 1e-9) << i;
    EXPECT_GE(bound.time, 0.96 * time) << i;  // plans of such corners are close to it
  }
}

TEST(CornerBound, AlikeCornersAreSolvedOnce) {
  std::string text = "G91 G64 P0.05 F6000\n";
  for (int i = 0; i < 20; ++i) text += "G1 X20\nG1 Y20\n";
  const Machine m = machine_of(1.0);
  const CornerBound bound = program_corner_bound(test::path_of(text + "M2\n", m), m, 1e-3, Deadline(60.0));
  EXPECT_EQ(bound.corners, 39U);
  EXPECT_EQ(bound.counted, 39U);
  EXPECT_LE(bound.classes, 8U);  // two classes, at some of their speeds
}

TEST(CornerBound, OfExactStopsIsTheClosedForm) {
  // From rest to rest, with one length for each case. One reaches the feed and moves along at it; one does not reach
  // it. With a jerk limit the ramps take v/a + a/j. Or v t = L at the highest speed v, with t = 2 sqrt(v/j) and L = 2
  // v^1.5/sqrt(j).
  constexpr double T = 1e-6;
  const Machine smooth = machine_of(1.0), jerky = machine_of(1.0, 50.0);
  const auto time = [&](const std::string& text, const Machine& m) {
    const Toolpath path = test::path_of("G61.1 F6000\n" + text + "M2\n", m);
    return program_corner_bound(path, program_machine(m, path), T, Deadline(60.0)).time;
  };
  EXPECT_NEAR(time("G1 X50\n", smooth), 0.5 + 0.1, 2.0 * T);
  EXPECT_NEAR(time("G1 X4\nG1 Y2.5\n", smooth), 2.0 * std::sqrt(0.004) + 2.0 * std::sqrt(0.0025), 3.0 * T);
  EXPECT_NEAR(time("G1 X50\n", jerky), 0.5 + 0.1 + 0.02, 3.0 * T);
  const double speed = std::cbrt(1e-4 * 1e-4 * 50.0 / 4.0);
  EXPECT_NEAR(time("G1 X0.1\n", jerky), 4.0 * std::sqrt(speed / 50.0), 3.0 * T);
}

TEST(CornerBound, MultipliersBoundEverySpeed) {
  // Solved at one pair of speeds, the multipliers bound the losses at others from below; in common ones they are close.
  const double in[] = {1.0, 0.0}, out[] = {-0.5, std::sqrt(0.75)};
  const Machine m = machine_of(1.0);
  const auto loss = [&](double v, double w) {
    return corner_loss({in, out, v, w, 0.2, 1.1 * v, 1.1 * w, 5e-5}, m, 2, 80);
  };
  const CornerDual at = loss(0.1, 0.1);
  for (const double v : {0.05, 0.08, 0.1, 0.14}) {
    for (const double w : {0.05, 0.08, 0.1, 0.14}) {
      EXPECT_LE(at.at(v / 0.1, w / 0.1), loss(v, w).at() + 2e-3) << v << " " << w;  // their periods differ
    }
    if (v > 0.05) {
      EXPECT_GE(at.at(v / 0.1, v / 0.1), 0.7 * loss(v, v).at()) << v;
    }
  }
}

TEST(CornerBound, IsNotAbovePlansOfRandomPrograms) {
  // Legs of 1 to 12 mm, most too short to come to their feed; some stops.
  std::mt19937 random(15);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  double sum = 0.0, plans = 0.0;
  for (int i = 0; i < test_support::tries(40); ++i) {
    const Machine m = machine_of(i % 4 < 2 ? 0.5 : 2.0, i % 2 == 0 ? 50.0 : unlimited);
    std::string text = fmt::format("G91 G64 P{} F6000\n", i % 3 == 0 ? 0.3 : 0.03);
    const double shortest = i % 5 == 0 ? 1.0 : 5.0;
    for (int b = 0; b < 12; ++b) {
      const double angle = 2.0 * std::numbers::pi * unit(random), length = shortest + 7.0 * unit(random);
      text += fmt::format("G1 X{:.6f} Y{:.6f}\n", length * std::cos(angle), length * std::sin(angle));
      if (unit(random) < 0.05) text += "G4 P0.1\n";
    }
    const Toolpath path = test::path_of(text + "M2\n", m);
    const CornerBound bound = program_corner_bound(path, m, 1e-3, Deadline(60.0));
    const ProfilePlan plan = plan_profiles(path, m, 1e-3);
    ASSERT_TRUE(plan.holds()) << text;
    const double time = static_cast<double>(plan.check.samples) * 1e-3;
    EXPECT_LE(bound.time, time * (1.0 + 1e-8)) << text;
    EXPECT_LE(program_lower_bound(path, m, 1e-3), time * (1.0 + 1e-8)) << text;
    sum += bound.time;
    plans += time;
  }
  EXPECT_GE(sum, 0.9 * plans);
}

TEST(CornerBound, CornersOfLegsThatCuttingWouldUseUpDoNotCount) {
  // A parabola takes 4 e/sqrt(2) = 2.8 mm of each leg at 1 mm.
  const Machine m = machine_of(1.0);
  const Toolpath path = test::path_of("G64 P1 F6000\nG1 X3\nG1 Y3\nM2\n", m);
  const CornerBound bound = program_corner_bound(path, m, 1e-3, Deadline(60.0));
  EXPECT_EQ(bound.counted, 0U);
  EXPECT_LE(bound.time, 2.0 * std::sqrt(0.006));  // as if it went straight on
  EXPECT_GE(bound.time, 0.06);                    // way over feed
}

TEST(CornerBound, CountsTheSameCornersUnderAnyDeadline) {
  // A motion is off its samples' polyline by a T^2/6 under a jerk limit and a T^2/8 without, a of both axes. A corner
  // takes 4 (e + that)/sqrt(2) of each leg; legs 1.5 times as long count. These legs are between both.
  const double e = 1e-3, off = std::numbers::sqrt2 * 1e-6, with = e + off / 6.0, without = e + off / 8.0;
  const double leg = 1.5 * 4.0 / std::numbers::sqrt2 * 0.5 * (with + without);
  const Machine m = machine_of(1.0, 50.0);
  const Toolpath path = test::path_of(fmt::format("G64 P1 F6000\nG1 X{0:.9f}\nG1 Y{0:.9f}\nM2\n", 1e3 * leg), m);
  for (const double seconds : {0.0, 60.0})
    EXPECT_EQ(program_corner_bound(path, m, 1e-3, Deadline(seconds)).counted, 1U) << seconds;
}

}  // namespace
}  // namespace accdec
