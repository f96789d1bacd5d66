#include <cmath>
#include <numbers>
#include <stdexcept>

#include <gtest/gtest.h>

#include <accdec/corner.hpp>

#include "support/random_case.hpp"

namespace accdec {
namespace {

using test::Random;
using test::uniform;

using std::numbers::pi;

// The digits of a product of directions tell turns of 1e-8 from none; legs in line must have none.
TEST(Corner, LegsInLineAreStraightWhateverTheirLengths) {
  Random random(3);
  for (int i = 0; i < 500; ++i) {
    const Eigen::Vector3d leg(uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1));
    EXPECT_EQ(make_corner(leg, uniform(random, 0.1, 10) * leg, 0.1, 0.1).cos_interior(), -1.0);
    // 1 - cos of the turn is half its square, less a twelfth of that times the square.
    const double turn = uniform(random, 1e-6, 1e-3);
    const Corner bent = planar_corner(pi - turn, uniform(random, -7, 7), Turn::left, 0.1, 0.1);
    EXPECT_NEAR(1.0 + bent.cos_interior(), 0.5 * turn * turn, 2e-16 + 1e-7 * turn * turn);
  }
}

TEST(Corner, PlanarAngleHeadingAndTurn) {
  Random random(1);
  for (int i = 0; i < 500; ++i) {
    const double angle = uniform(random, 0.02, pi), heading = uniform(random, -7, 7);
    const Corner left = planar_corner(angle, heading, Turn::left, 0.1, 0.2, 3);
    const Corner right = planar_corner(angle, heading, Turn::right, 0.1, 0.2, 3);
    for (const Corner& c : {left, right}) {
      EXPECT_EQ(c.axes(), 3);
      EXPECT_NEAR(c.direction_in.norm(), 1.0, 1e-15);
      EXPECT_NEAR(c.direction_out.norm(), 1.0, 1e-15);
      EXPECT_NEAR(c.cos_interior(), std::cos(angle), 1e-14);
      EXPECT_NEAR(c.direction_in[0], std::cos(heading), 1e-14);
      EXPECT_NEAR(c.direction_in[1], std::sin(heading), 1e-14);
      EXPECT_EQ(c.direction_out[2], 0.0);
    }
    // z component of u1 x u2: positive for a left turn.
    const auto cross = [](const Corner& c) {
      return c.direction_in[0] * c.direction_out[1] - c.direction_in[1] * c.direction_out[0];
    };
    EXPECT_NEAR(cross(left), std::sin(angle), 1e-14);
    EXPECT_NEAR(cross(right), -std::sin(angle), 1e-14);
  }
}

TEST(Corner, RoundAnglesAreExact) {
  const Corner straight = planar_corner(pi, 0.0, Turn::left, 1, 1);
  EXPECT_EQ(straight.cos_interior(), -1.0);
  EXPECT_EQ(straight.direction_out[1], 0.0);
  const Corner square = planar_corner(pi / 2, pi / 2, Turn::right, 1, 1);
  EXPECT_EQ(square.direction_in[0], 0.0);
  EXPECT_EQ(square.direction_out[0], 1.0);
  EXPECT_EQ(square.direction_out[1], 0.0);
}

TEST(Corner, DirectionsOfAnyLength) {
  const Corner c = make_corner(Eigen::Vector3d(1e-200, 0, 0), Eigen::Vector3d(0, 3e200, 4e200), 0.1, 0.2);
  EXPECT_EQ(c.direction_in[0], 1.0);
  EXPECT_DOUBLE_EQ(c.direction_out[1], 0.6);
  EXPECT_DOUBLE_EQ(c.direction_out[2], 0.8);
  EXPECT_EQ(c.cos_interior(), 0.0);
  EXPECT_EQ(make_corner(Eigen::VectorXd::Ones(1), -Eigen::VectorXd::Ones(1), 1, 1).cos_interior(), 1.0);
}

TEST(Corner, RefusesArgumentsOutOfRange) {
  const double nan = std::nan(""), inf = HUGE_VAL;
  const Eigen::Vector2d x(1, 0), y(0, 1);
  for (double bad : {0.0, -0.1, nan, inf}) {
    EXPECT_THROW(make_corner(x, y, bad, 1), std::invalid_argument);
    EXPECT_THROW(make_corner(x, y, 1, bad), std::invalid_argument);
  }
  EXPECT_THROW(make_corner(Eigen::Vector2d::Zero(), y, 1, 1), std::invalid_argument);
  EXPECT_THROW(make_corner(x, Eigen::Vector2d(nan, 1), 1, 1), std::invalid_argument);
  EXPECT_THROW(make_corner(x, Eigen::Vector2d(inf, 1), 1, 1), std::invalid_argument);
  EXPECT_THROW(make_corner(x, Eigen::Vector3d(1, 0, 0), 1, 1), std::invalid_argument);
  EXPECT_THROW(make_corner(Eigen::VectorXd(), Eigen::VectorXd(), 1, 1), std::invalid_argument);
  for (double bad : {0.0, -1.0, 3.2, nan, inf}) {
    EXPECT_THROW(planar_corner(bad, 0, Turn::left, 1, 1), std::invalid_argument);
  }
  EXPECT_THROW(planar_corner(1, nan, Turn::left, 1, 1), std::invalid_argument);
  EXPECT_THROW(planar_corner(1, 0, Turn::left, 1, 1, 1), std::invalid_argument);
}

}  // namespace
}  // namespace accdec
