#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include <accdec/plan/free/cone_program.hpp>

namespace accdec {
namespace {

/// The largest x + y of a point of the plane, as the last unknown t <= x + y.
struct Largest {
  ConeProgram program{3, 2, 2};
  LinearPoint point;
  std::vector<double> z{0.3, -0.2, 0.0};

  Largest() {
    LinearForm below;  // -99 <= t - x - y - ... <= 0, times a scale
    below.constant = 1.0;
    below.add(2, 0.01);
    below.add(0, -0.01);
    below.add(1, -0.01);
    program.bound(below);
    point.sample = {0, -1};
    point.weight = {1.0, 0.0};
  }
  bool solve() { return program.solve(z, true); }
};

TEST(ConeProgram, FindsTheFarthestPointsOfDiscAndCapsule) {
  // A disc of radius r gives r sqrt(2); all points within r of the segment to (1, 0) give 1 more.
  const double origin[2] = {0.0, 0.0}, right[2] = {1.0, 0.0};
  for (const double radius : {1e-2, 1.0, 30.0}) {
    Largest disc;
    disc.program.within(disc.point, origin, origin, radius);
    ASSERT_TRUE(disc.solve()) << radius;
    EXPECT_NEAR(disc.z[2], radius * std::sqrt(2.0), 1e-5) << radius;
    Largest capsule;
    capsule.program.within(capsule.point, origin, right, radius);
    ASSERT_TRUE(capsule.solve()) << radius;
    EXPECT_NEAR(capsule.z[2], 1.0 + radius * std::sqrt(2.0), 1e-5) << radius;
  }
}

TEST(ConeProgram, FindsNoPointInDiscsThatAreApart) {
  const double origin[2] = {0.0, 0.0}, far[2] = {3.0, 0.0}, near[2] = {1.9, 0.0};
  Largest apart;
  apart.program.within(apart.point, origin, origin, 1.0);
  apart.program.within(apart.point, far, far, 1.0);
  EXPECT_FALSE(apart.solve());
  Largest touching;
  touching.program.within(touching.point, origin, origin, 1.0);
  touching.program.within(touching.point, near, near, 1.0);
  ASSERT_TRUE(touching.solve());
  // The upper point where both circles meet: (0.95, sqrt(1 - 0.95^2)).
  EXPECT_NEAR(touching.z[2], 0.95 + std::sqrt(1.0 - 0.95 * 0.95), 1e-5);
}

}  // namespace
}  // namespace accdec
