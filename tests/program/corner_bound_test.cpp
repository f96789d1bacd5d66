#include <cmath>
#include <numbers>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <accdec/program/plan/corner_bound.hpp>
#include <accdec/program/profiles/plan_profiles.hpp>

#include "reference.hpp"
#include "support/paths.hpp"

namespace accdec {
namespace {

Machine machine(double acceleration, double jerk = unlimited) {
  Machine m;
  for (const char* name : {"x", "y"}) {
    Axis axis;
    axis.name = name;
    axis.velocity_max = 0.2;
    axis.acceleration_max = acceleration;
    axis.jerk_max = jerk;
    m.axes.push_back(axis);
  }
  return m;
}

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
  const BoundCorner right{in, out, F, F, 0.12, 0.12, e};
  const double bound = corner_time_bound(right, machine(a), 2, 1e-3);
  EXPECT_LE(bound, lost * (1.0 + 1e-9));
  EXPECT_GE(bound, lost - 5e-4);
}

TEST(CornerBound, NoToleranceCostsAStop) {
  // Straight back: from F to rest and to F, 2 F/a of which half is lost.
  const double in[] = {1.0, 0.0}, out[] = {-1.0, 0.0};
  const BoundCorner back{in, out, 0.1, 0.1, 0.12, 0.12, 0.0};
  const double bound = corner_time_bound(back, machine(1.0), 2, 1e-3);
  EXPECT_LE(bound, 0.1 + 1e-9);
  EXPECT_GE(bound, 0.099);
}

TEST(CornerBound, IsNotAbovePlansOfLongLegs) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int i = 0; i < 12; ++i) {
    const double jerk = i % 3 == 0 ? 50.0 : unlimited;
    const Machine m = machine(1.0, jerk);
    const Toolpath path =
        test::path_of(corner(360.0 * unit(random), 5.0 + 170.0 * unit(random), 0.01 + 0.2 * unit(random)), m);
    const CornerBound bound = program_corner_bound(path, m, 1e-3, 60.0);
    const ProfilePlan plan = plan_profiles(path, m, 1e-3);
    ASSERT_TRUE(plan.holds());
    EXPECT_EQ(bound.counted, 1U);
    // The bound is of continuous motion; of one that is sampled the jerk is a mean over three periods, which saves one
    // a run.
    const double time = static_cast<double>(plan.check.samples) * 1e-3;
    EXPECT_LE(bound.time, time + 1e-9) << i;
    EXPECT_GE(bound.time, 0.96 * time) << i;  // plans of such corners are close to it
  }
}

TEST(CornerBound, AlikeCornersAreSolvedOnce) {
  std::string text = "G91 G64 P0.05 F6000\n";
  for (int i = 0; i < 20; ++i) text += "G1 X20\nG1 Y20\n";
  const Machine m = machine(1.0);
  const CornerBound bound = program_corner_bound(test::path_of(text + "M2\n", m), m, 1e-3, 60.0);
  EXPECT_EQ(bound.corners, 39U);
  EXPECT_EQ(bound.counted, 39U);
  EXPECT_EQ(bound.classes, 2U);
}

TEST(CornerBound, CornersOfShortLegsDoNotCount) {
  // 5 mm are not enough for 100 mm/s and back at 1 m/s^2, which takes 10 mm.
  const Machine m = machine(1.0);
  const Toolpath path = test::path_of("G64 P0.05 F6000\nG1 X5\nG1 Y5\nM2\n", m);
  const CornerBound bound = program_corner_bound(path, m, 1e-3, 60.0);
  EXPECT_EQ(bound.counted, 0U);
  EXPECT_NEAR(bound.time, 0.1, 1e-9);  // way over feed
}

}  // namespace
}  // namespace accdec
