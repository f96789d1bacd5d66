// Properties of corner errors that hold for every filter, each over random filters, angles and feeds.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include <accdec/corner.hpp>

#include "support/random_case.hpp"

namespace accdec {
namespace {

using test::integer;
using test::log_uniform;
using test::Random;
using test::random_filter;
using test::uniform;

using std::numbers::pi;
constexpr double period = 1e-3;

Corner corner_of(double angle, double v1, double v2) {
  return planar_corner(angle, 0.4, Turn::left, v1, v2);
}

TEST(Property, ErrorFallsWithDelayUpToARightAngleThePolylineErrorAtAnyAngle) {
  Random random(1);
  int risen = 0;
  for (int i = 0; i < 3000; ++i) {
    const Filter in = random_filter(random, 25), out = i % 2 == 0 ? in : random_filter(random, 25);
    const double angle = i % 3 == 0 ? uniform(random, 0.01, pi / 2) : uniform(random, 0.01, pi);
    const Corner corner = corner_of(angle, uniform(random, 0.1, 1), uniform(random, 0.1, 1));
    CornerMeasures before = measure(Blend(in, out, corner, -5, period));
    for (int d = -4; d <= 27; ++d) {
      const CornerMeasures m = measure(Blend(in, out, corner, d, period));
      const double slack = 1e-13 * period * 60;
      if (angle <= pi / 2) {
        ASSERT_LE(m.corner_error, before.corner_error + slack) << angle << " " << d;
      }
      ASSERT_LE(m.polyline_error, before.polyline_error + slack) << angle << " " << d;
      ASSERT_LE(m.polyline_error, m.corner_error + slack);
      risen += m.corner_error > before.corner_error + 1e-6 * period;
      before = m;
    }
  }
  EXPECT_GT(risen,
            0);  // the sampled error of flat corners does rise here and there: that is why the two are told apart
}

// A straight pass with two taps 1/2 and equal feeds. At d = 0 one sample lies half a step before the point and one half
// a step after it. The polyline passes through it.
TEST(Property, SampledErrorOfAStraightPassIsNotThatOfThePolyline) {
  const Filter filter({1, 1});
  const Corner corner = corner_of(pi, 0.5, 0.5);
  const CornerMeasures m = measure(Blend(filter, corner, 0, period));
  EXPECT_DOUBLE_EQ(m.corner_error, 0.5 * 0.5 * period);
  EXPECT_NEAR(m.polyline_error, 0.0, 1e-18);
}

TEST(Property, ExactStopFromTheOrderOn) {
  Random random(2);
  for (int i = 0; i < 2000; ++i) {
    const Filter f = random_filter(random, 30);
    const Corner corner = corner_of(uniform(random, 0.01, 3.1), uniform(random, 0.1, 1), uniform(random, 0.1, 1));
    const int overlap = f.last_nonzero_tap() - f.first_nonzero_tap();
    for (int d : {overlap, f.order(), f.order() + 1, f.order() + 7}) {
      const CornerMeasures m = measure(Blend(f, corner, d, period));
      EXPECT_EQ(m.corner_error, 0.0);
      EXPECT_EQ(m.polyline_error, 0.0);
      EXPECT_EQ(m.contour_deviation, 0.0);
      if (d > overlap) {
        EXPECT_EQ(m.speed_min, 0.0);
      }
    }
    if (overlap > 0) {
      EXPECT_GT(corner_error(Blend(f, corner, overlap - 1, period)), 0.0);
    }
  }
}

TEST(Property, ZeroPaddingChangesNothing) {
  Random random(3);
  for (int i = 0; i < 500; ++i) {
    const Filter f = random_filter(random, 30);
    std::vector<double> after(f.taps().begin(), f.taps().end()), around(2, 0.0);
    after.resize(after.size() + 4, 0.0);
    around.insert(around.end(), after.begin(), after.end());
    const Filter padded(after), shifted(around);
    const Corner corner = corner_of(uniform(random, 0.01, pi), uniform(random, 0.1, 1), uniform(random, 0.1, 1));
    const int d = integer(random, 0, 32);
    const CornerMeasures a = measure(Blend(f, corner, d, period));
    for (const Filter* other : {&padded, &shifted}) {
      const CornerMeasures b = measure(Blend(*other, corner, d, period));
      EXPECT_NEAR(a.corner_error, b.corner_error, 1e-10 * period);
      EXPECT_NEAR(a.polyline_error, b.polyline_error, 1e-10 * period);
      EXPECT_NEAR(a.contour_deviation, b.contour_deviation, 1e-10 * period);
      EXPECT_NEAR(a.speed_min, b.speed_min, 1e-10);
    }
  }
}

TEST(Property, ErrorsScaleWithTheFeed) {
  Random random(4);
  for (int i = 0; i < 500; ++i) {
    const Filter f = random_filter(random, 30);
    const double angle = uniform(random, 0.01, pi), v1 = uniform(random, 0.1, 1), v2 = uniform(random, 0.1, 1);
    const double s = log_uniform(random, 1e-3, 1e3);
    const int d = integer(random, 0, 32);
    const Corner slow = corner_of(angle, v1, v2), fast = corner_of(angle, s * v1, s * v2);
    const CornerMeasures a = measure(Blend(f, slow, d, period)), b = measure(Blend(f, fast, d, period));
    EXPECT_NEAR(s * a.corner_error, b.corner_error, 1e-12 * s * period);
    EXPECT_NEAR(s * a.polyline_error, b.polyline_error, 1e-10 * s * period);
    EXPECT_NEAR(s * a.contour_deviation, b.contour_deviation, 1e-12 * s * period);
    EXPECT_NEAR(s * a.speed_min, b.speed_min, 1e-12 * s);
    // The same in time: half the feed at twice the sample period is the same path.
    const Corner half = corner_of(angle, v1 / 2, v2 / 2);
    EXPECT_NEAR(measure(Blend(f, half, d, 2 * period)).corner_error, a.corner_error, 1e-15 * period);
  }
}

TEST(Property, MirroredAndRotatedCornersHaveTheSameErrors) {
  Random random(5);
  for (int i = 0; i < 500; ++i) {
    const Filter f = random_filter(random, 30);
    const double angle = uniform(random, 0.02, 3.1), v1 = uniform(random, 0.1, 1), v2 = uniform(random, 0.1, 1);
    const int d = integer(random, 0, 32);
    const Corner reference = planar_corner(angle, 0, Turn::left, v1, v2);
    const Corner mirrored = planar_corner(angle, 0, Turn::right, v1, v2);
    const double heading = uniform(random, -pi, pi);
    const Corner rotated = planar_corner(angle, heading, Turn::left, v1, v2, 5);
    const Blend a(f, reference, d, period), m(f, mirrored, d, period), r(f, rotated, d, period);
    const double tolerance = 1e-11 * period * (f.order() + 1);
    EXPECT_NEAR(corner_error(a), corner_error(m), tolerance);
    EXPECT_NEAR(corner_error(a), corner_error(r), tolerance);
    EXPECT_NEAR(measure(a).contour_deviation, measure(r).contour_deviation, tolerance);
    for (int k = 0; k <= a.last_sample(); ++k) {
      const Eigen::VectorXd s = a.position(k), sm = m.position(k), sr = r.position(k);
      EXPECT_NEAR(s[0], sm[0], tolerance);
      EXPECT_NEAR(s[1], -sm[1], tolerance);
      EXPECT_NEAR(sr[0], std::cos(heading) * s[0] - std::sin(heading) * s[1], tolerance);
      EXPECT_NEAR(sr[1], std::sin(heading) * s[0] + std::cos(heading) * s[1], tolerance);
      EXPECT_EQ(sr[4], 0.0);
    }
  }
}

// Running the film backwards: reversed taps, legs swapped and turned round. S[k] becomes S[N + d - k].
TEST(Property, ReversedMotionHasTheSameErrors) {
  Random random(6);
  for (int i = 0; i < 1000; ++i) {
    const Filter in = random_filter(random, 30), out = i % 2 == 0 ? in : random_filter(random, 30);
    const Filter rin(std::vector<double>(out.taps().rbegin(), out.taps().rend()));
    const Filter rout(std::vector<double>(in.taps().rbegin(), in.taps().rend()));
    const Corner corner = corner_of(uniform(random, 0.01, pi), uniform(random, 0.1, 1), uniform(random, 0.1, 1));
    const Corner back = make_corner(-corner.direction_out, -corner.direction_in, corner.feed_out, corner.feed_in);
    // Leg 2 ends its change at N2 + d, leg 1 at N1; reversed, the command edges lie N1 and N2 + d back from a common
    // end.
    const int d = integer(random, -5, 32), reversed_delay = out.order() + d - in.order();
    const Blend a(in, out, corner, d, period), b(rin, rout, back, reversed_delay, period);
    const double tolerance = 1e-12 * period * (in.order() + out.order() + 40);
    for (int k = a.first_sample(); k <= a.last_sample(); ++k) {
      ASSERT_LT((a.position(k) - b.position(out.order() + d - k)).norm(), tolerance);
    }
    const CornerMeasures ma = measure(a), mb = measure(b);
    EXPECT_NEAR(ma.polyline_error, mb.polyline_error, 1e-8 * period);
    EXPECT_NEAR(ma.contour_deviation, mb.contour_deviation, tolerance);
    EXPECT_NEAR(ma.speed_min, mb.speed_min, 1e-8);
    EXPECT_NEAR(ma.corner_error, mb.corner_error, 1e-8 * period);
  }
}

}  // namespace
}  // namespace accdec
