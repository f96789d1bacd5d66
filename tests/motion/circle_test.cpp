#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <accdec/filter.hpp>
#include <accdec/motion/circle.hpp>

namespace accdec {
namespace {

// |H| of N + 1 equal taps is the Dirichlet kernel |sin((N + 1) x/2)/((N + 1) sin(x/2))| at x rad a sample.
TEST(CircleError, OfTheBoxcarIsTheDirichletKernels) {
  const double radius = 0.02, feed = 0.2, period = 1e-3;
  for (const int order : {0, 1, 7, 40, 200}) {
    const double x = feed * period / radius;
    const double kernel = std::abs(std::sin(0.5 * (order + 1) * x) / ((order + 1) * std::sin(0.5 * x)));
    EXPECT_NEAR(circle_error(boxcar(order), radius, feed, period).radius_error, radius * (1.0 - kernel), 1e-15);
  }
}

// The term v^2 sigma^2/(2 R) is the first one of a series. The next one has relative size (v sigma/R)^2. For N + 1
// equal taps, sigma^2 is ((N + 1)^2 - 1)/12 samples^2.
TEST(CircleError, SmallAngleFormula) {
  const double radius = 0.05, feed = 0.1, period = 1e-3;
  for (const int order : {1, 10, 40}) {
    const CircleError e = circle_error(boxcar(order), radius, feed, period);
    const double sigma = std::sqrt(((order + 1.0) * (order + 1.0) - 1.0) / 12.0) * period;
    EXPECT_NEAR(e.deviation, sigma, 1e-14);
    EXPECT_NEAR(e.small_angle, feed * feed * sigma * sigma / (2.0 * radius), 1e-15);
    const double next = std::pow(feed * sigma / radius, 2);
    EXPECT_NEAR(e.radius_error / e.small_angle, 1.0, next) << order;
  }
}

// The simulated turn is longer than the filter, so it reaches the shrunken circle. While the filter fills and empties,
// points at rest count too; they are nearer to the circle.
TEST(CircleError, AgreesWithAWholeTurnSimulated) {
  for (const Filter& filter : {trapezoid(30, 8), hann(25), exponential(22, 0.95), blackman_sinc(40, 0.049)}) {
    for (const double radius : {0.005, 0.05, 0.5}) {
      const CircleError e = circle_error(filter, radius, 0.1, 1e-3);
      EXPECT_NEAR(e.simulated, e.radius_error, 1e-9 * radius);
    }
  }
}

// One axis d samples behind the other makes an ellipse whose radii have the squares R^2 (1 +- sin(x d)).
TEST(CircleError, OfAxesThatDifferIsAnEllipses) {
  const double radius = 0.02, feed = 0.2, period = 1e-3, x = feed * period / radius;
  for (const int d : {1, 3, 10}) {
    std::vector<double> late(static_cast<std::size_t>(d) + 1, 0.0);
    late.back() = 1.0;
    const Filter first({1.0}), second(late);
    const double s = std::sin(x * d);
    const double expected = radius * std::max(1.0 - std::sqrt(1.0 - s), std::sqrt(1.0 + s) - 1.0);
    for (const auto& [a, b] : {std::pair(&first, &second), std::pair(&second, &first)}) {
      const CircleError e = circle_error(*a, *b, radius, feed, period);
      EXPECT_NEAR(e.radius_error, expected, 1e-12);
      EXPECT_NEAR(e.simulated, expected, 2.0 * x * x * expected);
      EXPECT_NEAR(e.small_angle, 0.5 * feed * period * d, 1e-12);
    }
  }
  const Filter swings = Filter::of_any_sign({1.2, -0.2});  // |H|^2 = 1 + 0.48 (1 - cos x)
  const double wider = radius * (std::sqrt(1.0 + 0.48 * (1.0 - std::cos(x))) - 1.0);
  EXPECT_NEAR(circle_error(swings, radius, feed, period).radius_error, wider, 1e-12);
  EXPECT_THROW(circle_error(boxcar(19), boxcar(20), 1e6, 0.1, 1e-3), std::invalid_argument);
}

TEST(CircleError, OfManySamplesIsFoundFromThoseThatDiffer) {
  const CircleError e = circle_error(boxcar(19), 1e6, 0.1, 1e-3);  // a turn of 6e10 samples
  EXPECT_NEAR(e.radius_error, e.small_angle, 1e-6 * e.small_angle);
  EXPECT_LT(e.simulated, 1e-9);  // far below the rounding of positions of a million metres
  EXPECT_THROW(circle_error(boxcar(circle_order_max + 1), 1.0, 0.1, 1e-3), std::invalid_argument);
}

TEST(CircleError, WhatIsNoCircleIsRefused) {
  EXPECT_THROW(circle_error(boxcar(3), 0.0, 0.1, 1e-3), std::invalid_argument);
  EXPECT_THROW(circle_error(boxcar(3), 0.1, -0.1, 1e-3), std::invalid_argument);
  EXPECT_THROW(circle_error(boxcar(3), 1e-5, 0.1, 1e-3), std::invalid_argument);
}

}  // namespace
}  // namespace accdec
