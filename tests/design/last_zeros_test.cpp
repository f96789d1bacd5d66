#include <cmath>
#include <numbers>
#include <vector>

#include <gmock/gmock.h>

#include <accdec/design/last_zeros.hpp>

#include "support/tasks.hpp"

namespace accdec {
namespace {

using testing::plane_corner;
using testing::plane_task;

std::vector<double> without(const Task& task, std::vector<double> taps) {
  const Filter filter = without_last_zeros(task, Filter(std::move(taps)), {0});
  return {filter.taps().begin(), filter.taps().end()};
}

/// A leg that goes straight on: no filter breaks a limit.
Task straight_on() {
  return plane_task({}, plane_corner("A", 180.0, 0.0, 0.1, 0.1), std::nullopt);
}

TEST(LastZeros, AreTakenAwayDownToTheLeastOrder) {
  Task task = straight_on();
  const std::vector<double> taps{0.25, 0.75, 0.0, 0.0, 0.0};
  EXPECT_THAT(without(task, taps), ::testing::ElementsAre(0.25, 0.75));
  EXPECT_THAT(without(task, {0.25, 0.0, 0.75}), ::testing::ElementsAre(0.25, 0.0, 0.75));
  EXPECT_THAT(without(task, {1.0, 0.0, 0.0}), ::testing::ElementsAre(1.0, 0.0));  // order_min is 1
  task.design.order_min = 3;
  EXPECT_THAT(without(task, taps), ::testing::ElementsAre(0.25, 0.75, 0.0, 0.0));
}

TEST(LastZeros, OfSymmetricTapsAreTakenFromBothEnds) {
  Task task = straight_on();
  task.design.symmetric = true;
  const std::vector<double> taps{0.0, 0.0, 0.5, 0.5, 0.0, 0.0};
  EXPECT_THAT(without(task, taps), ::testing::ElementsAre(0.5, 0.5));
  task.design.order_min = 2;
  EXPECT_THAT(without(task, taps), ::testing::ElementsAre(0.0, 0.5, 0.5, 0.0));
}

TEST(LastZeros, InWhichADampedModeDiesAwayStay) {
  constexpr double frequency = 50.0, damping = 0.1, zeros = 5.5;
  Task task = straight_on();
  // One impulse rings as exp(-z w t): it is small enough after five and a half samples.
  const double allowed = std::exp(-damping * 2.0 * std::numbers::pi * frequency * zeros * task.sample_period);
  task.machine.modes.push_back({frequency, frequency, allowed, damping, damping});
  EXPECT_THAT(without(task, {1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0}),
              ::testing::ElementsAre(1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0));
}

}  // namespace
}  // namespace accdec
