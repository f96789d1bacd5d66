#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include <accdec/corner.hpp>

#include "support/random_case.hpp"

namespace accdec {
namespace {

using test::integer;
using test::log_uniform;
using test::Random;
using test::uniform;

using std::numbers::pi;
constexpr double one_degree = pi / 180.0;

/// Position by numerical integration of the two clipped ramps with the midpoint rule. The rule is exact for each linear
/// piece if the kinks fall on cell edges; otherwise it is wrong by less than v tau / n^2. It shares only the start, Eq.
/// (4), with the closed form.
Eigen::Vector2d integrated(double theta, double v1, double v2, double tau, double delay, double t, int n) {
  const Eigen::Vector2d u1(std::sin(theta / 2), -std::cos(theta / 2)), u2(std::sin(theta / 2), std::cos(theta / 2));
  Eigen::Vector2d s = -0.5 * v1 * tau * u1;
  const double h = t / n;
  for (int i = 0; i < n; ++i) {
    const double m = (i + 0.5) * h;
    const double in = m < tau ? v1 * (1 - m / tau) : 0.0;
    const double out = m < delay ? 0.0 : m < delay + tau ? v2 * (m - delay) / tau : v2;
    s += h * (in * u1 + out * u2);
  }
  return s;
}

TEST(Linear, TrajectoryIsTheIntegralOfTheRamps) {
  Random random(1);
  for (int i = 0; i < 200; ++i) {
    const double theta = uniform(random, 0.01, pi), v1 = uniform(random, 0.1, 1), v2 = uniform(random, 0.1, 1),
                 tau = 0.04;
    const double delay = uniform(random, 0, 0.07), t = uniform(random, 0, 0.13);
    const LinearCorner corner(theta, v1, v2, tau, delay);
    const int n = 20000;
    const Eigen::Vector2d expected = integrated(theta, v1, v2, tau, delay, t, n);
    EXPECT_LT((corner.position(t) - expected).norm(), 4 * t * t / tau / n / n) << theta << " " << delay << " " << t;
  }
}

TEST(Linear, OverlapIsEquations13And14WithTheirMisprintsCorrected) {
  Random random(2);
  for (int i = 0; i < 1000; ++i) {
    const double theta = uniform(random, 0.01, pi), v0 = uniform(random, 0.1, 1), c = log_uniform(random, 0.1, 10),
                 tau = 0.041;
    const double dt = uniform(random, 0, tau), t = uniform(random, dt, tau);
    const LinearCorner corner(theta, v0, c * v0, tau, dt);
    const double sine = std::sin(theta / 2), cosine = std::cos(theta / 2);
    const Eigen::Vector2d v = corner.velocity(t), s = corner.position(t);
    EXPECT_NEAR(v[0], v0 * ((c - 1) / tau * t + 1 - c * dt / tau) * sine, 1e-13 * v0 * c);
    EXPECT_NEAR(v[1], v0 * ((c + 1) / tau * t - 1 - c * dt / tau) * cosine, 1e-13 * v0 * (c + 1));
    EXPECT_NEAR(s[0], v0 / 2 * ((c - 1) / tau * t * t + 2 * (1 - c * dt / tau) * t + c * dt * dt / tau - tau) * sine,
                1e-13 * v0 * tau * (c + 1));
    EXPECT_NEAR(s[1], v0 / 2 * ((c + 1) / tau * t * t - 2 * (1 + c * dt / tau) * t + c * dt * dt / tau + tau) * cosine,
                1e-13 * v0 * tau * (c + 1));
    EXPECT_NEAR(corner.distance(t), s.norm(), 1e-18);
  }
}

TEST(Linear, EqualFeedsGiveEquations6And12) {
  const double v0 = 0.5, tau = 0.041;
  for (double theta : {1.0, 45.0, 90.0, 95.0, 150.0, 179.0}) {
    for (double part : {0.0, 0.25, 0.5, 0.9, 1.0, 1.7}) {
      const LinearCorner corner(theta * one_degree, v0, v0, tau, part * tau);
      const double overlap = std::max(0.0, 1 - part);
      const double expected = v0 * tau / 4 * std::cos(theta * one_degree / 2) * overlap * overlap;
      EXPECT_NEAR(corner.corner_error(), expected, 1e-15 * v0 * tau) << theta << " " << part;
      EXPECT_NEAR(corner.approximate_corner_error(), expected, 1e-15 * v0 * tau);
      if (part < 1) {
        EXPECT_NEAR(corner.closest_time(), (1 + part) * tau / 2, 1e-15);
      }
    }
  }
}

TEST(Linear, MinimumEqualsDenseSearch) {
  Random random(3);
  for (int i = 0; i < 300; ++i) {
    const double tau = 0.04;
    const double v1 = 0.3, v2 = v1 * log_uniform(random, 1e-3, 1e3);
    const LinearCorner corner(uniform(random, 0.01, pi), v1, v2, tau, uniform(random, 0, 1.3) * tau);
    double best = 1e9;
    const int n = 20000;
    const double cell = 3 * tau / n;
    for (int j = 0; j <= n; ++j) best = std::min(best, corner.distance(j * cell - 0.5 * tau));
    const double exact = corner.corner_error();
    EXPECT_LE(exact, best * (1 + 1e-12));
    // Half a cell away from the closest instant the path is at most this much longer than the distance.
    const double v = corner.velocity(corner.closest_time()).norm();
    EXPECT_GE(exact + v * cell / 2 + (v1 + v2) / tau * cell * cell / 8, best);
    const double slope = corner.position(corner.closest_time()).dot(corner.velocity(corner.closest_time()));
    EXPECT_NEAR(slope, 0.0, 1e-11 * (v * exact + 1e-9));
  }
}

TEST(Linear, StraightPassAtEqualFeedsGoesThroughThePoint) {
  EXPECT_NEAR(LinearCorner(pi, 0.5, 0.5, 0.041).corner_error(), 0.0, 1e-17);
  EXPECT_NEAR(LinearCorner(pi, 0.5, 1.5, 0.041).corner_error(), 0.0, 1e-17);
}

// Notes on Eq. (9): exact 4925.6 against 4831.9 at c = 2, v0 = 5e5 um/s, tau = 41 ms, theta = 90 deg.
TEST(Linear, Equation9IsShortByTwoPercentAtTwiceTheFeed) {
  const LinearCorner corner(90 * one_degree, 0.5, 1.0, 0.041);
  EXPECT_NEAR(corner.corner_error() * 1e6, 4925.6, 0.05);
  EXPECT_NEAR(corner.approximate_corner_error() * 1e6, 4831.9, 0.05);
  EXPECT_NEAR(corner.approximate_corner_error(), 0.5 * 0.041 / 2 * (2.0 / 3.0) * std::cos(pi / 4), 1e-16);  // Eq. (9)
  const LinearCorner delayed(70 * one_degree, 0.5, 1.0, 0.041, 0.01);
  const double t = (0.041 + 2 * 0.01) / 3;  // Eq. (15)
  EXPECT_NEAR(delayed.velocity(t)[1], 0.0, 1e-15);
  EXPECT_NEAR(delayed.approximate_corner_error(), delayed.position(t)[1], 1e-16);
}

TEST(Linear, Table1) {
  struct Row {
    double v1, printed[4];
  };
  const Row rows[] = {{5, {5462, 3118, 1430, 0}},
                      {4, {4370, 2494, 1144, 0}},
                      {3, {3277, 1871, 858, 0}},
                      {2, {2185, 1247, 572, 0}},
                      {1, {1092, 624, 286, 0}}};
  const double delays[] = {0, 10, 20, 41}, period = 1e-3;
  for (const Row& row : rows) {
    for (int i = 0; i < 4; ++i) {
      const LinearCorner corner(95 * one_degree, row.v1 * 0.1, 3 * row.v1 * 0.1, 41 * period, delays[i] * period);
      EXPECT_EQ(std::round(corner.sampled_corner_error(period) * 1e6), row.printed[i]) << row.v1 << " " << delays[i];
    }
  }
  const double first[] = {5462.1, 3117.6, 1430.0};
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(LinearCorner(95 * one_degree, 0.5, 1.5, 0.041, delays[i] * period).sampled_corner_error(period) * 1e6,
                first[i], 0.05);
  }
}

TEST(Linear, SampledErrorEqualsEverySample) {
  Random random(4);
  for (int i = 0; i < 2000; ++i) {
    const double tau = 0.04, period = tau * log_uniform(random, 1e-3, 2.0);
    const LinearCorner corner(uniform(random, 0.01, pi), 0.3, 0.3 * log_uniform(random, 0.05, 20), tau,
                              uniform(random, 0, 1.5) * tau);
    double best = 1e9;
    for (int k = -2; k * period < 3 * tau + 2 * period; ++k) best = std::min(best, corner.distance(k * period));
    EXPECT_DOUBLE_EQ(corner.sampled_corner_error(period), best);
  }
}

TEST(Linear, ErrorScalesWithTheSquareOfTheOverlapForAnyFeeds) {
  Random random(5);
  for (int i = 0; i < 1000; ++i) {
    const double theta = uniform(random, 0.01, pi), v1 = 0.4, v2 = v1 * log_uniform(random, 0.02, 50), tau = 0.05;
    const double part = uniform(random, 0, 1);
    const double none = LinearCorner(theta, v1, v2, tau).corner_error();
    EXPECT_NEAR(LinearCorner(theta, v1, v2, tau, part * tau).corner_error(), none * (1 - part) * (1 - part),
                1e-13 * (v1 + v2) * tau);
    const double bound = none * uniform(random, 0, 1.2);
    const double delay = LinearCorner(theta, v1, v2, tau, 0.3 * tau).smallest_delay(bound);
    EXPECT_NEAR(LinearCorner(theta, v1, v2, tau, delay).corner_error(), std::min(bound, none), 1e-13 * (v1 + v2) * tau);
    EXPECT_GE(delay, 0.0);
  }
  EXPECT_EQ(LinearCorner(1.0, 0.5, 0.5, 0.04).smallest_delay(0.0), 0.04);
}

TEST(Linear, RefusesArgumentsOutOfRange) {
  const double nan = std::nan(""), inf = HUGE_VAL;
  for (double bad : {0.0, -1.0, 4.0, nan, inf}) EXPECT_THROW(LinearCorner(bad, 1, 1, 1), std::invalid_argument) << bad;
  for (double bad : {0.0, -1.0, nan, inf}) {
    EXPECT_THROW(LinearCorner(1, bad, 1, 1), std::invalid_argument) << bad;
    EXPECT_THROW(LinearCorner(1, 1, bad, 1), std::invalid_argument) << bad;
    EXPECT_THROW(LinearCorner(1, 1, 1, bad), std::invalid_argument) << bad;
    EXPECT_THROW(LinearCorner(1, 1, 1, 1).sampled_corner_error(bad), std::invalid_argument) << bad;
  }
  for (double bad : {-1.0, nan, inf}) {
    EXPECT_THROW(LinearCorner(1, 1, 1, 1, bad), std::invalid_argument) << bad;
    EXPECT_THROW(LinearCorner(1, 1, 1, 1).smallest_delay(bad), std::invalid_argument) << bad;
  }
}

}  // namespace
}  // namespace accdec
