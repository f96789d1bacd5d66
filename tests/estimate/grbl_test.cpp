#include <numbers>
#include <sstream>

#include <gtest/gtest.h>

#include "estimated.hpp"

// GRBL's rules in closed form. tests/peers/estimates.py compares whole programs with GRBL's own planner.

namespace accdec {
namespace {

using test::acceleration;
using test::estimated;
using test::long_move;

TEST(GrblEstimate, OfALongMoveIsATrapezoid) {
  EXPECT_NEAR(estimated("grbl", "G1 X100 F6000\nM2\n"), long_move(100.0, 0.0, 100.0, 0.0), 1e-9);
}

// 3 : 4 : 5, so Y limits the path at 5/4 of its own limits.
TEST(GrblEstimate, RapidMovesUseEveryAxis) {
  EXPECT_NEAR(estimated("grbl", "G0 X60 Y80\nM2\n"), long_move(100.0, 0.0, 250.0, 0.0, 1250.0), 1e-9);
}

// The circle that leaves the corner by the junction deviation. Both axes turn the velocity, so sqrt(2) a.
TEST(GrblEstimate, CornersArePassedByTheirJunctionDeviation) {
  const double half = std::sqrt(0.5);
  for (const double deviation : {0.01, 0.05}) {
    const double corner = std::sqrt(std::sqrt(2.0) * acceleration * deviation * half / (1.0 - half));
    EXPECT_NEAR(estimated("grbl", "G1 X100 F6000\nY100\nM2\n", {{"junction_deviation", deviation}}),
                long_move(100.0, 0.0, 100.0, corner) + long_move(100.0, corner, 100.0, 0.0), 1e-9);
  }
}

// With k moves of 1 mm behind the present one, no move begins faster than k mm can brake; each peaks in its middle.
TEST(GrblEstimate, ShortMovesAreSlowerThanTheirBufferCanBrake) {
  const auto chain = [](int moves) {
    std::ostringstream text;
    text << "G1 F12000\n";
    for (int i = 1; i <= moves; ++i) text << "X" << i << "\n";
    text << "M2\n";
    return text.str();
  };
  for (const double buffer : {8.0, 16.0}) {
    const double start = std::sqrt(2.0 * acceleration * (buffer - 2.0));
    const double peak = std::sqrt(start * start + acceleration);
    const std::map<std::string, double> given{{"block_buffer_size", buffer}};
    const double more = estimated("grbl", chain(300), given) - estimated("grbl", chain(200), given);
    EXPECT_NEAR(more, 100.0 * 2.0 * (peak - start) / acceleration, 1e-9) << buffer;
  }
  const std::map<std::string, double> large{{"block_buffer_size", 1000.0}};
  EXPECT_NEAR(estimated("grbl", chain(300), large), long_move(300.0, 0.0, 200.0, 0.0), 1e-9);
}

// The feed is slow enough for the circle: the time is that of its polygon. It speeds up and brakes within its first and
// last side, whose direction leaves a little more acceleration than that of one axis.
TEST(GrblEstimate, OfACircleIsItsPolygon) {
  constexpr double radius = 10.0, tolerance = 0.01;
  const double pi = std::numbers::pi;
  const double parts = std::floor(pi * radius / std::sqrt(tolerance * (2.0 * radius - tolerance)));
  const double around = 2.0 * parts * radius * std::sin(pi / parts);
  EXPECT_NEAR(estimated("grbl", "G2 X0 Y0 I10 J0 F1200\nM2\n", {{"arc_tolerance", tolerance}, {"steps_per_mm", 1e7}}),
              long_move(around, 0.0, 20.0, 0.0, acceleration / std::cos(pi / parts)), 1e-7);
}

TEST(GrblEstimate, StopsForDwellsAndForTheSpindle) {
  const double two = 2.0 * long_move(50.0, 0.0, 100.0, 0.0);
  EXPECT_NEAR(estimated("grbl", "G1 X50 F6000\nG4 P0.25\nX100\nM2\n"), two + 0.25, 1e-9);
  EXPECT_NEAR(estimated("grbl", "G1 X50 F6000\nM3 S100\nX100\nM2\n"), two, 1e-9);
  EXPECT_NEAR(estimated("grbl", "G1 X50 F6000\n(M3 in a comment)\nX100\nM2\n"), long_move(100.0, 0.0, 100.0, 0.0),
              1e-9);
}

// 250 steps a mm: a move of 1.4 steps in Y is one of 1 step.
TEST(GrblEstimate, MovesEndOnWholeSteps) {
  EXPECT_NEAR(estimated("grbl", "G1 X30.0005 Y40.0015 F6000\nM2\n"), long_move(50.0, 0.0, 100.0, 0.0, 1250.0), 1e-9);
}

}  // namespace
}  // namespace accdec
