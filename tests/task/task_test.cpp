#include <cmath>
#include <numbers>
#include <stdexcept>

#include <gtest/gtest.h>

#include <accdec/task.hpp>

namespace accdec {
namespace {

/// The geometry follows legs and feeds, however they came to be.
TEST(TaskCorner, GeometryFollowsLegsAndFeeds) {
  for (const double degrees : {1.0, 37.0, 90.0, 179.0, 180.0}) {
    const double angle = degrees * std::numbers::pi / 180.0;
    TaskCorner corner("A", PlanarLegs{angle, 0.3, Turn::right}, 0.1, 0.2, 3);
    EXPECT_NEAR(corner.geometry().cos_interior(), std::cos(angle), 1e-15);
    EXPECT_NEAR(corner.geometry().direction_in[1], std::sin(0.3), 1e-15);
    EXPECT_EQ(corner.geometry().axes(), 3);
    corner.set_feeds(0.4, 0.5);
    EXPECT_EQ(corner.geometry().feed_in, 0.4);
    EXPECT_EQ(corner.geometry().feed_out, 0.5);
    EXPECT_NEAR(corner.geometry().cos_interior(), std::cos(angle), 1e-15);
    EXPECT_EQ(corner.geometry().axes(), 3);
  }
  const TaskCorner directed("B", DirectedLegs{{3.0, 4.0}, {0.0, -2.0}}, 0.1, 0.1);
  EXPECT_DOUBLE_EQ(directed.geometry().direction_in[0], 0.6);
  EXPECT_DOUBLE_EQ(directed.geometry().direction_out[1], -1.0);
}

TEST(TaskCorner, RefusesWhatIsNoCorner) {
  const auto planar = [](double angle, double in, double out, int axes) {
    return TaskCorner("A", PlanarLegs{angle, 0.0, Turn::left}, in, out, axes);
  };
  EXPECT_THROW(planar(0.0, 0.1, 0.1, 2), std::invalid_argument);
  EXPECT_THROW(planar(3.2, 0.1, 0.1, 2), std::invalid_argument);
  EXPECT_THROW(planar(1.0, 0.0, 0.1, 2), std::invalid_argument);
  EXPECT_THROW(planar(1.0, 0.1, 0.1, 1), std::invalid_argument);
  EXPECT_THROW(TaskCorner("A", DirectedLegs{{1.0, 0.0}, {1.0}}, 0.1, 0.1), std::invalid_argument);
  EXPECT_THROW(TaskCorner("A", DirectedLegs{{1.0, 0.0}, {0.0, 0.0}}, 0.1, 0.1), std::invalid_argument);
  TaskCorner corner = planar(1.0, 0.1, 0.1, 2);
  EXPECT_THROW(corner.set_feeds(0.1, -1.0), std::invalid_argument);
  EXPECT_EQ(corner.geometry().feed_out, 0.1);
}

}  // namespace
}  // namespace accdec
