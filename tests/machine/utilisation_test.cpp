#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <accdec/machine.hpp>

#include "support/convolution.hpp"
#include "support/random_case.hpp"

namespace accdec {
namespace {

using test::Convolution;
using test::integer;
using test::Random;
using test::random_corner_in_space;
using test::random_filter;
using test::uniform;

using std::numbers::pi;

/// The value that a limit bounds, from the simulated stream alone.
double counted(LimitKind kind, const Axis& axis, const Convolution& plain, Eigen::Index a, int n) {
  const double v = plain.velocity(n)[a], acc = plain.acceleration(n)[a], force = axis.mass * acc + axis.damping * v;
  switch (kind) {
    case LimitKind::velocity: return std::abs(v);
    case LimitKind::acceleration: return std::abs(acc);
    case LimitKind::jerk: return std::abs(plain.jerk(n)[a]);
    case LimitKind::force: return std::abs(force);
    case LimitKind::power: return force * v;
    case LimitKind::regeneration: return -force * v;
    default: ADD_FAILURE(); return 0.0;
  }
}

Axis random_axis(Random& random, int index) {
  Axis axis;
  axis.name = std::string(1, static_cast<char>('a' + index));
  axis.velocity_max = uniform(random, 0.1, 2);
  axis.acceleration_max = uniform(random, 1, 20);
  axis.jerk_max = uniform(random, 50, 2000);
  axis.mass = integer(random, 0, 4) == 0 ? 0.0 : uniform(random, 1, 300);
  axis.damping = integer(random, 0, 4) == 0 ? 0.0 : uniform(random, 1, 2000);
  axis.force_max = uniform(random, 100, 1000);
  axis.power_max = uniform(random, 20, 500);
  axis.regeneration_max = uniform(random, 20, 500);
  return axis;
}

TEST(Utilisation, EqualsTheWorstOfTheSimulatedStream) {
  Random random(1);
  for (int i = 0; i < 200; ++i) {
    const int axes = integer(random, 2, 5), delay = integer(random, 0, 45);
    const Filter filter = random_filter(random, 40);
    const Corner corner = random_corner_in_space(random, axes, uniform(random, 0.02, pi));
    const double period = uniform(random, 1e-4, 2e-3);
    Machine machine;
    for (int a = 0; a < axes; ++a) machine.axes.push_back(random_axis(random, a));
    const Convolution plain(filter, filter, corner, delay, period);
    const std::vector<LimitUse> uses = axis_utilisation(filter, corner, delay, period, machine, "A");
    ASSERT_EQ(uses.size(), static_cast<std::size_t>(6 * axes));
    for (std::size_t u = 0; u < uses.size(); ++u) {
      const LimitUse& use = uses[u];
      const auto a = static_cast<Eigen::Index>(u / 6);
      const Axis& axis = machine.axes[u / 6];
      double worst = 0.0;
      for (int n = plain.first(); n <= plain.last(); ++n) worst = std::max(worst, counted(use.kind, axis, plain, a, n));
      // Rounding of the convolved speed, carried through one or two differences and the plant.
      const double v = 2.0, rounding = 1e-14 * (filter.order() + 10);
      const double force = axis.mass * v / period + axis.damping * v;
      const double scale[] = {v, v / period, 2 * v / period / period, force, force * v, force * v};
      const double tolerance = rounding * scale[u % 6];
      EXPECT_EQ(use.axis, axis.name);
      EXPECT_EQ(use.corner, "A");
      EXPECT_NEAR(use.value, worst, tolerance) << to_string(use.kind);
      EXPECT_DOUBLE_EQ(use.utilisation, use.value / use.bound);
      // The value stands where the result says it does.
      ASSERT_NE(use.event, Event::none);
      const int origin = use.event == Event::start ? plain.start() : use.event == Event::stop ? plain.stop() : 0;
      EXPECT_NEAR(std::max(0.0, counted(use.kind, axis, plain, a, origin + use.sample)), worst, tolerance)
          << to_string(use.kind) << " " << to_string(use.event) << " " << use.sample;
    }
  }
}

TEST(Utilisation, OnlyFiniteLimitsAreReportedInAxisOrder) {
  Machine machine;
  machine.axes.resize(2);
  machine.axes[0].name = "x";
  machine.axes[1].name = "y";
  machine.axes[0].power_max = 10;
  machine.axes[0].velocity_max = 1;
  machine.axes[1].jerk_max = 100;
  const Corner corner = planar_corner(1.0, 0.0, Turn::left, 0.1, 0.2);
  const auto uses = axis_utilisation(boxcar(4), corner, 0, 1e-3, machine);
  ASSERT_EQ(uses.size(), 3u);
  EXPECT_EQ(uses[0].axis, "x");
  EXPECT_EQ(uses[0].kind, LimitKind::velocity);
  EXPECT_EQ(uses[1].axis, "x");
  EXPECT_EQ(uses[1].kind, LimitKind::power);
  EXPECT_EQ(uses[2].axis, "y");
  EXPECT_EQ(uses[2].kind, LimitKind::jerk);
}

// An axis that reverses. Without delay both legs brake it at once, with twice the acceleration of a start or stop, and
// the edges of both boxcars fall on the same sample. From d = N + 1 on they follow each other.
TEST(Utilisation, ReversalDoublesTheAcceleration) {
  Machine machine;
  machine.axes.resize(1);
  machine.axes[0].acceleration_max = 5;
  machine.axes[0].jerk_max = 1e4;
  const Eigen::VectorXd x = Eigen::VectorXd::Ones(1);
  const Corner corner = make_corner(x, -x, 0.1, 0.1);
  const double period = 1e-3, step = 0.1 / 10 / period;
  auto uses = axis_utilisation(boxcar(9), corner, 0, period, machine);
  EXPECT_NEAR(uses[0].value, 2 * step, 1e-12 * step);
  EXPECT_EQ(uses[0].event, Event::blend);
  EXPECT_NEAR(uses[1].value, 2 * step / period, 1e-12 * step / period);
  uses = axis_utilisation(boxcar(9), corner, 10, period, machine);
  EXPECT_NEAR(uses[0].value, step, 1e-12 * step);
  EXPECT_NEAR(uses[1].value, step / period, 1e-12 * step / period);
}

TEST(Utilisation, MotionAtRestUsesNothing) {
  Machine machine;
  machine.axes.resize(2);
  for (Axis& axis : machine.axes) {
    axis.velocity_max = axis.acceleration_max = axis.jerk_max = axis.force_max = axis.power_max =
        axis.regeneration_max = 1;
    axis.mass = 1;
  }
  const Corner straight = planar_corner(pi, 0.0, Turn::left, 0.5, 0.5);
  const auto uses = axis_utilisation(hann(10), straight, 0, 1e-3, machine);
  for (std::size_t u = 6; u < 12; ++u) {
    EXPECT_EQ(uses[u].value, 0.0);
    EXPECT_EQ(uses[u].utilisation, 0.0);
  }
}

TEST(Utilisation, Conventions) {
  EXPECT_EQ(utilisation_of(LimitKind::force, 3, 4), 0.75);
  EXPECT_EQ(utilisation_of(LimitKind::speed_min, 4, 3), 0.75);
  EXPECT_EQ(utilisation_of(LimitKind::vibration, 0, 0), 0.0);
  EXPECT_EQ(utilisation_of(LimitKind::vibration, 0.1, 0), unlimited);
  EXPECT_EQ(utilisation_of(LimitKind::speed_min, 0.0, 0.1), unlimited);
  EXPECT_EQ(utilisation_of(LimitKind::speed_min, 0.1, 0.0), 0.0);
  EXPECT_EQ(to_string(LimitKind::regeneration), "regeneration");
  EXPECT_EQ(to_string(Event::blend), "blend");
}

TEST(Utilisation, RefusesUnequalNumbersOfAxesAndBadPeriods) {
  Machine machine;
  machine.axes.resize(3);
  const Corner corner = planar_corner(1, 0, Turn::left, 1, 1);
  EXPECT_THROW(axis_utilisation(boxcar(3), corner, 0, 1e-3, machine), std::invalid_argument);
  machine.axes.resize(2);
  for (double bad : {0.0, -1e-3, std::nan(""), HUGE_VAL}) {
    EXPECT_THROW(axis_utilisation(boxcar(3), corner, 0, bad, machine), std::invalid_argument);
    EXPECT_THROW(vibration_utilisation(boxcar(3), bad, machine), std::invalid_argument);
  }
}

}  // namespace
}  // namespace accdec
