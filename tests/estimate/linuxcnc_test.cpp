#include <numbers>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include <accdec/estimate/linuxcnc.hpp>

#include "estimated.hpp"

// LinuxCNC's rules in closed form. results/program/estimates.md compares whole programs with LinuxCNC itself.

namespace accdec {
namespace {

using test::acceleration;
using test::estimated;
using test::long_move;

constexpr const char* control = "linuxcnc-2.9";
const double across = std::sqrt(0.75) * acceleration;  // mm/s^2, what arcs have across them

TEST(LinuxCncEstimate, OfALongMoveIsATrapezoid) {
  EXPECT_NEAR(estimated(control, "G61.1\nG1 X100 F6000\nM2\n"), long_move(100.0, 0.0, 100.0, 0.0), 1e-9);
}

// The last move under G64 waits for a blend that never comes.
TEST(LinuxCncEstimate, TheLastMoveUnderG64HasHalfItsAcceleration) {
  EXPECT_NEAR(estimated(control, "G64 P0.05\nG1 X100 F6000\nM2\n"), long_move(100.0, 0.0, 100.0, 0.0, 500.0), 1e-9);
}

TEST(LinuxCncEstimate, RapidMovesUseEveryAxis) {
  // 3 : 4 : 5, so Y limits the path at 5/4 of its own limits; the speed is below that of Y's limit.
  const double peak = std::sqrt(25.0 * 1250.0);
  EXPECT_NEAR(estimated(control, "G61.1\nG0 X15 Y20\nM2\n"), 2.0 * peak / 1250.0, 1e-9);
}

// An arc of constant speed leaves a right angle by the tolerance.
TEST(LinuxCncEstimate, CornersAreArcsWithinTheTolerance) {
  for (const double tolerance : {0.1, 0.5}) {
    const double radius = tolerance / (std::sqrt(2.0) - 1.0), corner = std::sqrt(across * radius);
    std::ostringstream program;
    program << "G64 P" << tolerance << "\nG1 X100 F6000\nG61.1\nY100\nM2\n";
    EXPECT_NEAR(estimated(control, program.str()),
                long_move(100.0 - radius, 0.0, 100.0, corner) + long_move(100.0 - radius, corner, 100.0, 0.0) +
                    0.5 * std::numbers::pi * radius / corner,
                1e-9)
        << tolerance;
  }
}

// Half of the acceleration along the circle, and the rest across.
TEST(LinuxCncEstimate, OfACircleIsItsConstantSpeed) {
  constexpr double radius = 10.0;
  const double speed = std::sqrt(across * radius);
  EXPECT_NEAR(estimated(control, "G61.1\nG2 X0 Y0 I10 J0 F12000\nM2\n"),
              long_move(2.0 * std::numbers::pi * radius, 0.0, speed, 0.0, 0.5 * acceleration), 1e-4);
}

// A circle that the velocity of the axes limits has more of it along its way, whatever the feed.
TEST(LinuxCncEstimate, LargeCirclesHaveMoreAccelerationAlongThem) {
  constexpr double radius = 100.0, feed = 50.0;
  const double normal = test::velocity * test::velocity / radius,
               along = std::sqrt(acceleration * acceleration - normal * normal);
  EXPECT_NEAR(estimated(control, "G61.1\nG2 X0 Y0 I100 J0 F3000\nM2\n"),
              long_move(2.0 * std::numbers::pi * radius, 0.0, feed, 0.0, along), 1e-4);
}

/// X and A; a degree counts as a millimetre. A has 200 and 1000, as X.
double with_rotary_axis(const std::string& text) {
  Machine machine = test::estimated_machine();
  machine.axes.push_back(machine.axes[0]);
  machine.axes[1].name = "a";
  LineSource source("test.ngc", text);
  ToolpathOptions options;
  options.clamp_feeds = true;
  options.error_max = 1e-5;
  return estimate_time(read_toolpath(source, machine, options), machine, control).time;
}

// A move is as long as its way in X Y Z, and no axis exceeds its limits: A moves four times as far as X.
TEST(LinuxCncEstimate, OtherAxesLimitTheMovesTheyTakePartIn) {
  EXPECT_NEAR(with_rotary_axis("G61.1\nG1 A100 F6000\nM2\n"), long_move(100.0, 0.0, 100.0, 0.0), 1e-9);
  EXPECT_NEAR(with_rotary_axis("G61.1\nG1 X100 A400 F6000\nM2\n"), long_move(100.0, 0.0, 50.0, 0.0, 250.0), 1e-9);
  EXPECT_NEAR(with_rotary_axis("G61.1\nG1 X100 A50 F6000\nM2\n"), long_move(100.0, 0.0, 100.0, 0.0), 1e-9);
}

// There are no arcs between them: both moves have half their acceleration, and the second begins as the first brakes.
TEST(LinuxCncEstimate, OtherAxesAreBlendedByParabolas) {
  EXPECT_NEAR(with_rotary_axis("G64 P0.05\nG1 X50 F6000\nG61.1\nA50\nM2\n"),
              2.0 * long_move(50.0, 0.0, 100.0, 0.0, 500.0) - 100.0 / 500.0, 1e-9);
}

TEST(LinuxCncEstimate, ExactStopsAndChangesToRapidMovesStop) {
  const double two = 2.0 * long_move(50.0, 0.0, 100.0, 0.0);
  EXPECT_NEAR(estimated(control, "G61.1\nG1 X50 F6000\nX100\nM2\n"), two, 1e-9);
  const double rapid = long_move(50.0, 0.0, 200.0, 0.0);
  EXPECT_NEAR(estimated(control, "G64 P0.05\nG1 X50 F6000\nG61.1\nG0 X100\nM2\n"), 0.5 * two + rapid, 1e-9);
}

// Points within Q of one line are one move; Q is P where it is not given.
TEST(LinuxCncEstimate, MovesInLineWithinQAreMerged) {
  std::ostringstream points;
  for (int i = 1; i < 100; ++i) points << "X" << i << " Y" << (i % 2 == 0 ? 0.0 : 0.02) << "\n";
  const std::string moves = "\nG1 F6000\n" + points.str() + "X100 Y0\nG61.1\nX200\nM2\n";
  const double merged = estimated(control, "G64 P0.05" + moves);
  EXPECT_NEAR(merged, long_move(200.0, 0.0, 100.0, 0.0), 1e-2);
  EXPECT_NEAR(estimated(control, "G64 P0.05 Q0.05" + moves), merged, 1e-12);
  EXPECT_GT(estimated(control, "G64 P0.05 Q0" + moves), merged + 1e-2);
}

// A line along X meets an arc of radius A at a right angle. The blend of radius R touches the arc from outside: its
// centre is A + R from the arc's, and R above the line.
TEST(LinuxCncEstimate, ABlendIsTangentToALineAndAnArc) {
  constexpr double a = 0.01, r = 0.002;
  Piece line, arc;
  line.first = line.last = Vector(1.0, 0.0, 0.0);
  line.length = line.nominal = 0.02;
  arc.arc = true;
  arc.radius = a;
  arc.center = Vector(a, 0.0, 0.0);
  arc.axis = Vector(0.0, 0.0, 1.0);
  arc.first = Vector(0.0, 1.0, 0.0);
  const double d = std::sqrt((a + r) * (a + r) - r * r) - a, left = std::hypot(d, r) - r;
  const auto blend = tangent_arc(line, arc, r, left * 1.001, 1.0, 1.0);
  ASSERT_TRUE(blend);
  EXPECT_NEAR(blend->taken_before, d, 1e-15);
  EXPECT_NEAR(blend->taken_after, a * std::atan2(r, a + d), 1e-15);
  EXPECT_NEAR(blend->length, r * std::atan2(a + d, r), 1e-15);
  EXPECT_FALSE(tangent_arc(line, arc, r, left * 0.999, 1.0, 1.0));
  EXPECT_FALSE(tangent_arc(line, arc, r, left * 1.001, 1.0, 0.999 * std::atan2(r, a + d)));
  arc.axis = Vector(0.0, 1.0, 0.0);
  EXPECT_FALSE(tangent_arc(line, arc, r, left * 1.001, 1.0, 1.0));
}

TEST(LinuxCncEstimate, TheReaderKeepsPathModes) {
  const Toolpath path =
      test::estimated_path("G64 P0.1 Q0.02\nG1 X1 F600\nX2\nG64 P0.1\nX3\nG61.1\nX4\nG20 G64 P0.1 Q0.01\nX5\nM2\n");
  ASSERT_EQ(path.modes.size(), 4u);
  EXPECT_EQ(path.modes[0].block, 0u);
  EXPECT_NEAR(path.modes[0].merge, 2e-5, 1e-18);
  EXPECT_EQ(path.modes[1].block, 2u);
  EXPECT_LT(path.modes[1].merge, 0.0);
  EXPECT_EQ(path.modes[2].control, PathControl::exact_stop);
  EXPECT_NEAR(path.modes[3].merge, 0.01 * 0.0254, 1e-18);
}

// As rs274 prints them: P once more as Q where no Q is given, and both numbers again behind a cycle, here in inches.
TEST(LinuxCncEstimate, TheReaderKeepsPathModesOfCanonicalCalls) {
  const std::string feed = "N0000000003 STRAIGHT_FEED(", rest = ", 0, 0, 0, 0, 0)\n";
  const std::string both = "SET_MOTION_CONTROL_MODE(CANON_CONTINUOUS, 0.1)\nN0000000003 SET_NAIVECAM_TOLERANCE(0.02)\n";
  const Toolpath path = test::estimated_path(
      "N0000000001 USE_LENGTH_UNITS(CANON_UNITS_MM)\nN0000000001 SET_FEED_RATE(600)\nN0000000001 " + both + feed + "1" +
      rest +
      "N0000000002 USE_LENGTH_UNITS(CANON_UNITS_INCHES)\nN0000000003 SET_MOTION_CONTROL_MODE(CANON_EXACT_PATH)\n" +
      feed + "2" + rest + "N0000000003 " + both + feed + "3" + rest +
      "N0000000004 SET_MOTION_CONTROL_MODE(CANON_CONTINUOUS, 0.1)\nN0000000004 SET_NAIVECAM_TOLERANCE(0.1000)\n" +
      "N0000000004 STRAIGHT_FEED(4" + rest + "N0000000005 PROGRAM_END()\n");
  ASSERT_EQ(path.modes.size(), 4u);
  for (const std::size_t i : {0u, 2u}) {
    EXPECT_NEAR(path.modes[i].tolerance, 1e-4, 1e-18);
    EXPECT_NEAR(path.modes[i].merge, 2e-5, 1e-18);
  }
  EXPECT_NEAR(path.modes[3].tolerance, 0.1 * 0.0254, 1e-18);
  EXPECT_LT(path.modes[3].merge, 0.0);
}

}  // namespace
}  // namespace accdec
