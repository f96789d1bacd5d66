#include <numbers>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "estimated.hpp"

// Klipper's rules in closed form. tests/peers/estimates.py compares whole programs with Klipper itself.

namespace accdec {
namespace {

using test::acceleration;
using test::estimated;
using test::long_move;

TEST(KlipperEstimate, OfALongMoveIsATrapezoid) {
  EXPECT_NEAR(estimated("klipper", "G1 X100 F6000\nM2\n"), long_move(100.0, 0.0, 100.0, 0.0), 1e-9);
}

// The speed is what a ramp of (1 - ratio) times the acceleration reaches in half of the length.
TEST(KlipperEstimate, MinimumCruiseRatioLowersThePeakOfAShortMove) {
  for (const double ratio : {0.0, 0.3, 0.5}) {
    const double peak = std::sqrt(10.0 * acceleration * (1.0 - ratio));
    EXPECT_NEAR(estimated("klipper", "G1 X10 F12000\nM2\n", {{"minimum_cruise_ratio", ratio}}),
                long_move(10.0, 0.0, peak, 0.0), 1e-9)
        << ratio;
  }
}

// By its definition; at other angles by the circle that leaves the corner by as much as there.
TEST(KlipperEstimate, CornersArePassedAtTheSquareCornerVelocity) {
  const double square = 8.0;
  for (const double turn : {90.0, 45.0}) {
    const double radians = turn * std::numbers::pi / 180.0, sine = std::cos(0.5 * radians);
    const double corner = std::sqrt(square * square * (std::sqrt(2.0) - 1.0) * sine / (1.0 - sine));
    const std::string program = "G1 X100 F6000\nX" + std::to_string(100.0 + 100.0 * std::cos(radians)) + " Y" +
                                std::to_string(100.0 * std::sin(radians)) + "\nM2\n";
    EXPECT_NEAR(estimated("klipper", program, {{"square_corner_velocity", square}}),
                long_move(100.0, 0.0, 100.0, corner) + long_move(100.0, corner, 100.0, 0.0), 1e-6)
        << turn;
  }
}

// The polygon of a circle is passed at the speed whose centripetal acceleration on its inscribed circle is the limit.
TEST(KlipperEstimate, OfACircleIsTheCentripetalLimit) {
  constexpr double radius = 10.0;
  const double parts = std::floor(2.0 * std::numbers::pi * radius), half = std::numbers::pi / parts;
  const double inner = radius * std::cos(half), around = 2.0 * parts * radius * std::sin(half);
  const double speed = std::sqrt(acceleration * inner);
  const double time = estimated("klipper", "G2 X0 Y0 I10 J0 F6000\nM2\n", {{"square_corner_velocity", 20.0}});
  EXPECT_NEAR(time, long_move(around, 0.0, speed, 0.0), 2e-3 * time);
}

TEST(KlipperEstimate, StopsForDwellsOnly) {
  const double two = long_move(50.0, 0.0, 100.0, 0.0);
  EXPECT_NEAR(estimated("klipper", "G1 X50 F6000\nG4 P0.25\nX100\nM2\n"), 2.0 * two + 0.25, 1e-9);
  EXPECT_NEAR(estimated("klipper", "G61.1\nG1 X50 F6000\nM3\nX100\nM2\n"), long_move(100.0, 0.0, 100.0, 0.0), 1e-9);
}

TEST(KlipperEstimate, TakesZByItsOwnLimits) {
  EXPECT_NEAR(estimated("klipper", "G1 Z20 F6000\nM2\n", {{"max_z_velocity", 10.0}, {"max_z_accel", 100.0}}),
              long_move(20.0, 0.0, 10.0, 0.0, 100.0), 1e-9);
}

TEST(Estimate, NamesWhatItDoesNotKnow) {
  Machine machine = test::estimated_machine();
  machine.axes[0].jerk_max = 50.0;
  const Toolpath path = test::estimated_path("G64 P0.05\nG1 X100 F6000\nG61.1\nY100\nM2\n");
  const ControlEstimate klipper = estimate_time(path, machine, "klipper");
  EXPECT_THAT(klipper.unknown,
              testing::ElementsAre("the jerk limit", testing::HasSubstr("G64 P"), testing::HasSubstr("G61.1")));
  EXPECT_THAT(estimate_time(path, machine, "linuxcnc-2.9").unknown, testing::ElementsAre("the jerk limit"));
  const std::string text = estimate_text(klipper, 12.5);
  EXPECT_THAT(text, testing::HasSubstr("an estimate with max_velocity 200 mm/s, max_accel 1000 mm/s^2"));
  EXPECT_THAT(text, testing::HasSubstr("accdec's plan takes 12.5000 s\n  klipper does not know the jerk limit\n"));
}

void expect_refused(const std::string& control, const std::string& program, const std::map<std::string, double>& given,
                    const std::string& says) {
  try {
    estimated(control, program, given);
    ADD_FAILURE() << "accepted: " << says;
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr(says));
  }
}

TEST(Estimate, RefusesWhatItCannotDo) {
  const std::string move = "G1 X10 F600\nM2\n";
  expect_refused("kliper", move, {}, "did you mean \"klipper\"");
  expect_refused("grbl", move, {{"junction_deviatoin", 0.1}}, "did you mean \"junction_deviation\"");
  expect_refused("klipper", move, {{"minimum_cruise_ratio", 1.0}},
                 "minimum_cruise_ratio of klipper is 1; allowed is 0");
  expect_refused("klipper", move, {{"max_accel", 0.0}}, "max_accel of klipper is 0; allowed is 0.001");
  for (const std::string& control : estimated_controls()) {
    Machine machine = test::estimated_machine();
    machine.axes[0].acceleration_max = unlimited;
    EXPECT_THROW(estimate_time(test::estimated_path(move), machine, control), std::invalid_argument) << control;
    Toolpath rotary = test::estimated_path(move);
    rotary.axes[0] = 3;
    EXPECT_THROW(estimate_time(rotary, test::estimated_machine(), control), std::invalid_argument) << control;
  }
}

}  // namespace
}  // namespace accdec
