// Filters that are known to be best under one or two limits, and what they use of them.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include <accdec/corner.hpp>
#include <accdec/filter.hpp>
#include <accdec/machine.hpp>

#include "support/random_case.hpp"

namespace accdec {
namespace {

constexpr double period = 1e-3;

/// One axis that starts along leg 1 and stops; the corner itself is a straight pass.
Corner straight(double v) {
  const Eigen::VectorXd x = Eigen::VectorXd::Ones(1);
  return make_corner(x, x, v, v);
}

Machine machine_of(const Axis& axis) {
  Machine machine;
  machine.axes = {axis};
  return machine;
}

/// Taps of a start from rest whose speed after sample k is speeds[k - 1].
Filter from_speeds(const std::vector<double>& speeds) {
  std::vector<double> taps;
  for (std::size_t k = 0; k < speeds.size(); ++k) taps.push_back(speeds[k] - (k > 0 ? speeds[k - 1] : 0.0));
  return Filter(taps);
}

TEST(Analytic, AccelerationLimitAloneIsABoxcarOfVOverAT) {
  Axis axis;
  axis.acceleration_max = 6;
  for (double v : {0.05, 0.1, 0.25, 0.3}) {
    const int taps = static_cast<int>(std::ceil(v / (axis.acceleration_max * period) - 1e-9));
    EXPECT_LE(axis_utilisation(boxcar(taps - 1), straight(v), 0, period, machine_of(axis))[0].utilisation, 1 + 1e-12);
    EXPECT_GT(axis_utilisation(boxcar(taps - 2), straight(v), 0, period, machine_of(axis))[0].utilisation, 1.0);
  }
}

TEST(Analytic, AccelerationAndJerkLimitAreATrapezoidBothAtTheirBounds) {
  // Ramp of r steps of j T each to a, so a = j T r; then v = a T (N + 1 - ramp) with ramp = r - 1.
  for (int r : {1, 4, 10}) {
    for (int n : {2 * r - 2, 2 * r + 7, 40}) {
      Axis axis;
      axis.acceleration_max = 5;
      axis.jerk_max = axis.acceleration_max / (period * r);
      const double v = axis.acceleration_max * period * (n + 1 - (r - 1));
      const auto uses = axis_utilisation(trapezoid(n, r - 1), straight(v), 0, period, machine_of(axis));
      EXPECT_NEAR(uses[0].utilisation, 1.0, 1e-12) << r << " " << n;
      EXPECT_NEAR(uses[1].utilisation, 1.0, 1e-11) << r << " " << n;
    }
  }
}

TEST(Analytic, ForceLimitWithViscousFrictionIsADiscreteExponential) {
  Axis axis;
  axis.mass = 100;
  axis.damping = 800;
  axis.force_max = 600;
  const double v = 0.5, r = 1 / (1 + axis.damping * period / axis.mass);
  std::vector<double> speeds;
  // m (V[k] - V[k-1])/T + c V[k] = F gives V[k] = F/c (1 - r^k).
  for (int k = 1; speeds.empty() || speeds.back() < v; ++k) {
    speeds.push_back(std::min(v, axis.force_max / axis.damping * (1 - std::pow(r, k))));
  }
  const Filter filter = from_speeds(speeds);
  for (int k = 1; k < filter.order(); ++k) {
    EXPECT_NEAR(filter.tap(k) / filter.tap(k - 1), r, 1e-11);
    const double force = axis.mass * v * filter.tap(k - 1) / period + axis.damping * v * filter.cumulative(k);
    EXPECT_NEAR(force, axis.force_max, 1e-10 * axis.force_max);
  }
  const auto uses = axis_utilisation(filter, straight(v), 0, period, machine_of(axis));
  EXPECT_NEAR(uses[0].utilisation, 1.0, 1e-11);
  EXPECT_EQ(uses[0].event, Event::start);  // friction helps the stop
  // Continuous time: tau = -m/c log(1 - c v/F); implicit Euler is slower by a part c T/(2 m).
  const double tau = -axis.mass / axis.damping * std::log(1 - axis.damping * v / axis.force_max);
  EXPECT_NEAR((filter.order() + 1) * period, tau * (1 + axis.damping * period / axis.mass / 2), 1.5 * period);
}

TEST(Analytic, ForceThenPowerLimitWithoutFriction) {
  Axis axis;
  axis.mass = 100;
  axis.force_max = 600;
  axis.power_max = 120;
  const double v = 0.5, corner_speed = axis.power_max / axis.force_max, fine = 1e-5;
  std::vector<double> speeds;
  double now = 0.0;
  while (now < v) {
    // At the bound m (V - V0)/T V = P; V is the positive root.
    const double by_power = (now + std::sqrt(now * now + 4 * axis.power_max * fine / axis.mass)) / 2;
    now = std::min({v, now + axis.force_max * fine / axis.mass, by_power});
    speeds.push_back(now);
  }
  const Filter filter = from_speeds(speeds);
  const auto uses = axis_utilisation(filter, straight(v), 0, fine, machine_of(axis));
  EXPECT_NEAR(uses[0].utilisation, 1.0, 1e-9);
  EXPECT_NEAR(uses[1].utilisation, 1.0, 1e-9);
  // V(t) of the model, and its time to speed tau = m V*/F + m (v^2 - V*^2)/(2 P).
  const double knee = axis.mass * corner_speed / axis.force_max;
  const double tau = knee + axis.mass * (v * v - corner_speed * corner_speed) / (2 * axis.power_max);
  EXPECT_NEAR((filter.order() + 1) * fine, tau, 5 * fine);
  for (int k = 1; k * fine < tau; k += 100) {
    const double t = k * fine;
    const double expected = t <= knee
                                ? axis.force_max * t / axis.mass
                                : std::sqrt(corner_speed * corner_speed + 2 * axis.power_max * (t - knee) / axis.mass);
    EXPECT_NEAR(v * filter.cumulative(k), expected, 20 * axis.force_max / axis.mass * fine) << t;
  }
}

// Take all filters whose start from rest keeps the force limit. The one that saturates it at every sample is the
// fastest. It also has the smallest corner error at any angle.
TEST(Analytic, SaturatedStartIsFastestAndNearestToTheCorner) {
  const double v = 0.5, mass = 100, damping = 800, force = 600;
  const double a = force * period / mass / v, r = 1 / (1 + damping * period / mass);  // B[k] <= r (B[k-1] + a)
  const auto start = [&](auto use) {
    std::vector<double> speeds;
    for (double now = 0.0; now < 1.0;) {
      now = std::min(1.0, now + use() * (r * (now + a) - now));
      speeds.push_back(now);
    }
    return from_speeds(speeds);
  };
  const Filter best = start([] { return 1.0; });
  test::Random random(1);
  for (int i = 0; i < 2000; ++i) {
    const double least = test::uniform(random, 0.1, 0.999);
    const Filter other =
        start([&] { return test::uniform(random, 0, 2) < 1 ? 1.0 : test::uniform(random, least, 1.0); });
    ASSERT_GE(other.order(), best.order());
    const Corner corner = planar_corner(test::uniform(random, 0.02, 3.14), 0, Turn::left, v, v);
    EXPECT_GE(measure(Blend(other, corner, 0, period)).polyline_error,
              measure(Blend(best, corner, 0, period)).polyline_error);
  }
}

// Braking: the mirror of the power-limited start returns that power; a symmetric filter brakes as hard as it drives.
TEST(Analytic, RegenerationOfAStopIsThePowerOfTheReversedStart) {
  Axis axis;
  axis.mass = 40;
  axis.power_max = 100;
  axis.regeneration_max = 100;
  const Filter filter({1, 2, 4, 4, 3, 1});
  const Filter reversed({1, 3, 4, 4, 2, 1});
  const auto stop = axis_utilisation(filter, straight(0.3), 0, period, machine_of(axis));
  const auto start = axis_utilisation(reversed, straight(0.3), 0, period, machine_of(axis));
  EXPECT_EQ(stop[1].event, Event::stop);
  // Speeds at a step's end when driving are those at its beginning when braking: P = m a V differs by m a^2 T at that
  // sample.
  double braking = 0.0;
  for (int k = 1; k <= 6; ++k)
    braking = std::max(braking, 40 * 0.3 * filter.tap(k - 1) / period * 0.3 * filter.remaining(k));
  EXPECT_NEAR(stop[1].value, braking, 1e-9);
  EXPECT_GT(start[0].value, stop[1].value);
}

// Acceleration limit alone, right angle: boxcar at the bound, then the smallest delay for the tolerance.
TEST(Analytic, AccelerationLimitedCornerIsABoxcarWithTheSmallestDelay) {
  const double a = 6, v = 0.1, angle = std::numbers::pi / 2, tolerance = 50e-6;
  const int taps = static_cast<int>(std::ceil(v / (a * period) - 1e-9));
  const Filter filter = boxcar(taps - 1);
  Axis axis;
  axis.acceleration_max = a;
  Machine machine;
  machine.axes = {axis, axis};
  const Corner corner = planar_corner(angle, 0, Turn::left, v, v);
  const int d = DelayFinder(filter)(corner.cos_interior(), v * period, v * period, tolerance);
  EXPECT_LE(corner_error(Blend(filter, corner, d, period)), tolerance);
  EXPECT_GT(corner_error(Blend(filter, corner, d - 1, period)), tolerance);
  for (const LimitUse& use : axis_utilisation(filter, corner, d, period, machine))
    EXPECT_LE(use.utilisation, 1 + 1e-12);
  // Eq. (12): dT = tau (1 - sqrt(eps/eps0)), eps0 = v tau/4 cos(theta/2); a sample more or less for the rectangle rule.
  const double tau = taps * period, undelayed = v * tau / 4 * std::cos(angle / 2);
  EXPECT_NEAR(d, tau * (1 - std::sqrt(tolerance / undelayed)) / period, 1.5);
}

}  // namespace
}  // namespace accdec
