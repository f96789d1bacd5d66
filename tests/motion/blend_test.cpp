#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include <accdec/corner.hpp>

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
constexpr double degree = pi / 180.0;

/// Positions and speeds differ by rounding only: 1e-12 of the largest value of the kind in the blend.
TEST(Blend, EqualsPlainConvolutionOfTheCommands) {
  Random random(1);
  for (int i = 0; i < 400; ++i) {
    const int axes = 1 + i % 6;
    const Filter in = random_filter(random, 40), out = i % 2 == 0 ? in : random_filter(random, 40);
    const int delay = i % 2 == 0 ? integer(random, 0, 50) : integer(random, -45, 50);
    const Corner corner = axes == 1 ? make_corner(Eigen::VectorXd::Ones(1),
                                                  Eigen::VectorXd::Constant(1, i % 4 < 2 ? 1.0 : -1.0), 0.3, 0.7)
                                    : random_corner_in_space(random, axes, uniform(random, 1, 180) * degree);
    const double period = uniform(random, 1e-4, 2e-3);
    const Blend blend(in, out, corner, delay, period);
    const Convolution plain(in, out, corner, delay, period);
    const double v = std::max(corner.feed_in, corner.feed_out);
    const double length = v * period * (in.order() + out.order() + std::abs(delay) + 2);
    ASSERT_EQ(blend.first_sample(), std::min(0, delay));
    ASSERT_EQ(blend.last_sample(), std::max(in.order(), out.order() + delay) + 1);
    EXPECT_DOUBLE_EQ(blend.corner_time(), (blend.last_sample() - blend.first_sample()) * period);
    for (int k = blend.first_sample() - 2; k <= blend.last_sample() + 2; ++k) {
      ASSERT_LT((blend.position(k) - plain.position(k)).norm(), 1e-12 * length);
      ASSERT_LT((blend.velocity(k) - plain.velocity(k)).norm(), 1e-12 * v);
      ASSERT_LT((blend.acceleration(k) - plain.acceleration(k)).norm(), 1e-12 * v / period);
      ASSERT_LT((blend.jerk(k) - plain.jerk(k)).norm(), 2e-12 * v / period / period);
      // |S| and |V'| come from the law of cosines: near a straight pass the rounding of the cosine enters under a root.
      const double s2 = plain.position(k).squaredNorm(), v2 = plain.velocity(k).squaredNorm();
      ASSERT_NEAR(blend.distance(k) * blend.distance(k), s2, 1e-12 * length * length);
      ASSERT_NEAR(blend.tangential_speed(k) * blend.tangential_speed(k), v2, 1e-12 * v * v);
    }
    // Before and after the window nothing changes any more.
    EXPECT_LT((blend.velocity(blend.first_sample()) - corner.feed_in * corner.direction_in).norm(), 1e-12);
    EXPECT_LT((blend.velocity(blend.last_sample()) - corner.feed_out * corner.direction_out).norm(), 1e-12);
  }
}

/// Distance of x from the segment a - b, by projection in space.
double to_segment(const Eigen::VectorXd& x, const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  const Eigen::VectorXd d = b - a;
  const double t = d.squaredNorm() > 0 ? std::clamp((x - a).dot(d) / d.squaredNorm(), 0.0, 1.0) : 0.0;
  return (a + t * d - x).norm();
}

TEST(Blend, MeasuresEqualTheirDefinitionsOnTheSimulatedPath) {
  Random random(2);
  for (int i = 0; i < 300; ++i) {
    const Filter in = random_filter(random, 30), out = i % 2 == 0 ? in : random_filter(random, 30);
    const int delay = i % 2 == 0 ? integer(random, 0, 32) : integer(random, -20, 40);
    const Corner corner = random_corner_in_space(random, integer(random, 2, 4), uniform(random, 1, 179) * degree);
    const double period = 1e-3;
    const Convolution plain(in, out, corner, delay, period);
    const Blend blend(in, out, corner, delay, period);
    const CornerMeasures m = measure(blend);
    const Eigen::VectorXd zero = Eigen::VectorXd::Zero(corner.axes());
    const double far = 1e3;  // the programmed legs as long segments
    double error = 1e9, polyline = 1e9, speed = 1e9, deviation = 0.0;
    const int parts = 200;
    double cell = 0.0;
    for (int k = blend.first_sample(); k <= blend.last_sample(); ++k) {
      error = std::min(error, plain.position(k).norm());
      speed = std::min(speed, plain.velocity(k).norm());
      if (k == blend.first_sample()) continue;
      const Eigen::VectorXd &a = plain.position(k - 1), &b = plain.position(k);
      polyline = std::min(polyline, to_segment(zero, a, b));
      cell = std::max(cell, (b - a).norm() / parts);
      for (int j = 0; j <= parts; ++j) {
        const Eigen::VectorXd x = a + (b - a) * j / parts;
        deviation = std::max(deviation, std::min(to_segment(x, -far * corner.direction_in, zero),
                                                 to_segment(x, zero, far * corner.direction_out)));
      }
    }
    const double scale = period * (in.order() + out.order() + 2);  // feeds are at most 1 m/s
    EXPECT_NEAR(m.corner_error, error, 1e-12 * scale);
    EXPECT_NEAR(blend.distance(m.corner_error_sample), error, 1e-12 * scale);
    EXPECT_NEAR(corner_error(blend), error, 1e-12 * scale);
    EXPECT_NEAR(m.polyline_error, polyline, 1e-12 * scale);
    EXPECT_NEAR(m.speed_min, speed, 1e-12);
    EXPECT_NEAR(blend.tangential_speed(m.speed_min_sample), speed, 1e-12);
    // Dense points miss the apex by at most half a cell. Projection on a leg of 1 km costs rounding of 1e-13 m.
    EXPECT_GE(m.contour_deviation, deviation - 1e-12);
    EXPECT_LE(m.contour_deviation, deviation + cell / 2 + 1e-12);
  }
}

TEST(Blend, CornerErrorByBisectionEqualsTheScan) {
  Random random(3);
  for (int i = 0; i < 20000; ++i) {
    const Filter in = random_filter(random, 60), out = i % 2 == 0 ? in : random_filter(random, 60);
    const double angle = i % 5 == 0 ? pi - test::log_uniform(random, 1e-9, 0.1) : uniform(random, 1e-3, pi);
    const Corner corner = planar_corner(angle, 0.3, Turn::left, uniform(random, 0.02, 1), uniform(random, 0.02, 1));
    const Blend blend(in, out, corner, integer(random, -20, 70), 1e-3);
    ASSERT_EQ(corner_error(blend), measure(blend).corner_error) << i;
  }
}

// Eq. (24): eps = v0 T cos(theta/2) E|i - N/2|, symmetric taps, equal feeds, no delay, N even. With delay d, N + d
// even: eps = 2 v0 T cos(theta/2) E[max(i - N/2 - d/2, 0)] at k = (N + d)/2.
TEST(Blend, SymmetricFilterInClosedForm) {
  Random random(4);
  for (int i = 0; i < 2000; ++i) {
    const int order = 2 * integer(random, 0, 30), delay = 2 * integer(random, 0, order / 2 + 2);
    std::vector<double> taps(static_cast<std::size_t>(order) + 1);
    for (std::size_t j = 0; j <= taps.size() / 2; ++j) {
      taps[j] = taps[taps.size() - 1 - j] = integer(random, 0, 5) == 0 ? 0.0 : uniform(random, 0.0, 1.0);
    }
    taps[static_cast<std::size_t>(order / 2)] = 1.0;
    const Filter filter(taps);
    const double theta = uniform(random, 1, 180) * degree, v0 = uniform(random, 0.1, 1), period = 1e-3;
    double deviation = 0, overlap = 0;
    for (int j = 0; j <= order; ++j) {
      deviation += filter.tap(j) * std::abs(j - order / 2);
      overlap += filter.tap(j) * std::max(j - order / 2 - delay / 2, 0);
    }
    const Corner corner = planar_corner(theta, 1.0, Turn::right, v0, v0);
    const Blend none(filter, corner, 0, period), delayed(filter, corner, delay, period);
    // The cosine's rounding enters under a root at flat angles: 1e-12 of eps^2's scale.
    const double tolerance = std::min(1e-8, 1e-13 / std::cos(theta / 2) / std::cos(theta / 2));
    EXPECT_NEAR(corner_error(none), v0 * period * std::cos(theta / 2) * deviation, tolerance * v0 * period * order);
    EXPECT_NEAR(corner_error(delayed), 2 * v0 * period * std::cos(theta / 2) * overlap,
                tolerance * v0 * period * order);
    if (deviation > 0 && theta < 3.1) {
      EXPECT_EQ(measure(none).corner_error_sample, order / 2);
    }
  }
}

TEST(Blend, ContourDeviationAtASymmetricApexIsTheErrorTimesTheSineOfHalfTheAngle) {
  for (double angle : {5.0, 60.0, 95.0, 150.0, 175.0}) {
    for (int delay : {0, 4, 20, 40}) {
      const Corner corner = planar_corner(angle * degree, 0.2, Turn::left, 0.4, 0.4);
      const CornerMeasures m = measure(Blend(blackman_sinc(40, 0.049), corner, delay, 1e-3));
      EXPECT_NEAR(m.contour_deviation, m.corner_error * std::sin(angle * degree / 2), 1e-14) << angle << " " << delay;
      // At the apex the path is parallel to the a-axis, so the polyline is nowhere nearer than the middle sample.
      EXPECT_NEAR(m.polyline_error, m.corner_error, 1e-14);
    }
  }
}

// Paper, Table 2, with the lost header and the filter recovered: 95 deg, c = 3, T = 1 ms, d = 0, 5, 15, 41; 1 BLU = 1
// um.
TEST(Blend, Table2) {
  const Filter filter = blackman_sinc(40, 0.049);
  const int printed[5][4] = {
      {2442, 1333, 241, 0}, {1953, 1066, 193, 0}, {1465, 800, 145, 0}, {977, 533, 97, 0}, {488, 267, 48, 0}};
  const int delays[] = {0, 5, 15, 41};
  for (int row = 0; row < 5; ++row) {
    const double v1 = 0.1 * (5 - row);
    const Corner corner = planar_corner(95 * degree, 0, Turn::left, v1, 3 * v1);
    for (int i = 0; i < 4; ++i) {
      EXPECT_EQ(std::round(1e6 * corner_error(Blend(filter, corner, delays[i], 1e-3))), printed[row][i])
          << row << " " << i;
    }
  }
  const double first[] = {2441.87, 1332.90, 241.38};
  for (int i = 0; i < 3; ++i) {
    const Corner corner = planar_corner(95 * degree, 0, Turn::left, 0.5, 1.5);
    EXPECT_NEAR(1e6 * corner_error(Blend(filter, corner, delays[i], 1e-3)), first[i], 0.006);
  }
}

// Paper, Fig. 12: 100 mm/s, c = 2, 95 deg.
TEST(Blend, Figure12) {
  const Corner corner = planar_corner(95 * degree, 0, Turn::left, 0.1, 0.2);
  EXPECT_NEAR(1e6 * corner_error(Blend(blackman_sinc(40, 0.049), corner, 0, 1e-3)), 415.6, 0.05);
  EXPECT_NEAR(1e6 * corner_error(Blend(s_curve(40), corner, 4, 1e-3)), 412.5, 0.05);
}

TEST(Blend, RefusesABadSamplePeriod) {
  const Filter filter = boxcar(3);
  const Corner corner = planar_corner(1, 0, Turn::left, 1, 1);
  for (double bad : {0.0, -1.0, std::nan(""), HUGE_VAL}) {
    EXPECT_THROW(Blend(filter, corner, 0, bad), std::invalid_argument);
  }
}

}  // namespace
}  // namespace accdec
