#include <random>

#include <gtest/gtest.h>

#include <accdec/certificate/member_limits.hpp>
#include <accdec/task/delays_by_formula.hpp>
#include <accdec/verify.hpp>

#include "support/tasks.hpp"

// A slow servo alone asks for a delay, by which the checker refutes most members of a family. Here it stands against
// the smallest delays of filters, which the design's own search finds.

namespace accdec {
namespace {

Task corner_behind(double gain, std::mt19937& rng) {
  std::uniform_real_distribution<double> u(0.0, 1.0);
  Axis axis;
  axis.servo_gain = gain;
  const double feed = 0.05 + 0.1 * u(rng);
  return testing::plane_task(axis, testing::plane_corner("A", 5.0 + 170.0 * u(rng), 360.0 * u(rng), feed, 0.1),
                             1e-4 * (0.1 + u(rng)));
}

int smallest_delay(const Filter& filter, const Task& task) {
  const auto delays = delays_by_formula(filter, task, unlimited);
  return delays ? delays->front() : -1;
}

TEST(LeastDelayBehind, IsNotAboveThatOfAnyFilterAndCloseToThatOfNone) {
  std::mt19937 rng(61);
  for (int i = 0; i < 300; ++i) {
    SCOPED_TRACE(i);
    const Task task = corner_behind(i % 3 == 0 ? 16.67 : i % 3 == 1 ? 60.0 : 200.0, rng);
    const int least = least_delay_behind(CheckedResponse(task), granted_limits(task).corners[0], task.sample_period);
    const int plain = smallest_delay(Filter({1.0}), task);
    ASSERT_GE(plain, 0);
    EXPECT_LE(least, plain);
    // It takes p and q of neighbouring samples together, as they are together at the next delay. On flat angles a
    // longer delay need not be farther away.
    if (task.corners[0].geometry().cos_interior() >= 0.0) {
      EXPECT_GE(least, plain - 1);
    }
    for (int n = 0; n < 5; ++n) {
      const int delay = smallest_delay(testing::random_filter(rng, 1 + 15 * n), task);
      ASSERT_GE(delay, 0);
      EXPECT_LE(least, delay) << n;
    }
  }
}

TEST(LeastDelayBehind, IsNoneWithoutAServo) {
  std::mt19937 rng(62);
  for (int i = 0; i < 20; ++i) {
    const Task task = corner_behind(unlimited, rng);
    EXPECT_EQ(least_delay_behind(CheckedResponse(task), task.corners[0], task.sample_period), 0);
  }
}

}  // namespace
}  // namespace accdec
