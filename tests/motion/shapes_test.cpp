#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include <accdec/filter.hpp>

namespace accdec {
namespace {

using std::numbers::pi;

double mean_absolute_deviation(const Filter& f) {
  double sum = 0.0;
  for (int i = 0; i <= f.order(); ++i) sum += f.tap(i) * std::abs(i - 0.5 * f.order());
  return sum;
}

double largest_tap(const Filter& f) {
  return *std::max_element(f.taps().begin(), f.taps().end());
}

double largest_step(const Filter& f) {
  double step = 0.0;
  for (int i = 0; i <= f.order() + 1; ++i) step = std::max(step, std::abs(f.tap(i) - f.tap(i - 1)));
  return step;
}

std::vector<Filter> symmetric_shapes() {
  std::vector<Filter> all;
  for (int n : {2, 3, 4, 7, 40, 41, 200}) {
    for (const Filter& f : {boxcar(n), trapezoid(n, n / 3), trapezoid(n, n / 2), s_curve(n), hann(n), blackman(n),
                            blackman_sinc(n, 1.9 / n)}) {
      all.push_back(f);
    }
  }
  return all;
}

TEST(Shapes, AreSymmetricAndDelayByHalfTheOrder) {
  for (const Filter& f : symmetric_shapes()) {
    for (int i = 0; i <= f.order(); ++i) EXPECT_EQ(f.tap(i), f.tap(f.order() - i));
    EXPECT_NEAR(f.mean_delay(), 0.5 * f.order(), 1e-13 * f.order());
  }
}

TEST(Shapes, FollowTheirFormulas) {
  const int n = 40;
  double hann_sum = 0, blackman_sum = 0, sinc_sum = 0, quintic_sum = 0;
  const auto hann_at = [&](int i) { return 0.5 - 0.5 * std::cos(2 * pi * i / n); };
  const auto blackman_at = [&](int i) {
    return 0.42 - 0.5 * std::cos(2 * pi * i / n) + 0.08 * std::cos(4 * pi * i / n);
  };
  const auto sinc_at = [&](int i) {
    const double x = 0.049 * (i - 20);
    return blackman_at(i) * (i == 20 ? 1.0 : std::sin(pi * x) / (pi * x));
  };
  const auto quintic_at = [&](int i) {  // Eq. (31)
    const double t = static_cast<double>(i) / n;
    return 30 * t * t - 60 * t * t * t + 30 * t * t * t * t;
  };
  for (int i = 0; i <= n; ++i) {
    hann_sum += hann_at(i);
    blackman_sum += blackman_at(i);
    sinc_sum += sinc_at(i);
    quintic_sum += quintic_at(i);
  }
  for (int i = 0; i <= n; ++i) {
    EXPECT_NEAR(boxcar(n).tap(i), 1.0 / 41, 1e-16);
    EXPECT_NEAR(hann(n).tap(i), hann_at(i) / hann_sum, 1e-15);
    EXPECT_NEAR(blackman(n).tap(i), blackman_at(i) / blackman_sum, 1e-15);
    EXPECT_NEAR(blackman_sinc(n, 0.049).tap(i), sinc_at(i) / sinc_sum, 1e-15);
    EXPECT_NEAR(s_curve(n).tap(i), quintic_at(i) / quintic_sum, 1e-15);
  }
  for (const Filter& f : {hann(n), blackman(n), blackman_sinc(n, 0.049), s_curve(n)}) {
    EXPECT_EQ(f.tap(0), 0.0);
    EXPECT_EQ(f.tap(n), 0.0);
  }
}

// The step response of the discrete quintic tends to 10 t^3 - 15 t^4 + 6 t^5 (Eq. 30). The trapezoidal sum of a
// polynomial whose slope is zero at both ends is off by O(n^-2).
TEST(Shapes, QuinticIntegratesToTheSCurve) {
  const int n = 400;
  const Filter f = s_curve(n);
  for (int k = 0; k <= n; ++k) {
    const double t = static_cast<double>(k) / n;
    EXPECT_NEAR(f.cumulative(k) + 0.5 * f.tap(k), ((6 * t - 15) * t + 10) * t * t * t, 10.0 / n / n);
  }
}

TEST(Shapes, TrapezoidIsTwoBoxcarsInSeries) {
  for (int n : {5, 26, 40}) {
    for (int ramp = 0; ramp <= n / 2; ++ramp) {
      // Boxcars of ramp + 1 and n + 1 - ramp taps.
      const Filter f = trapezoid(n, ramp);
      const double scale = 1.0 / ((ramp + 1.0) * (n + 1.0 - ramp));
      for (int i = 0; i <= n; ++i) {
        int terms = 0;
        for (int j = 0; j <= ramp; ++j) terms += i - j >= 0 && i - j <= n - ramp;
        EXPECT_NEAR(f.tap(i), terms * scale, 1e-15) << n << " " << ramp << " " << i;
      }
    }
  }
  EXPECT_NEAR(trapezoid(12, 0).tap(5), 1.0 / 13, 1e-16);
}

// "The FIR filter has the smallest corner error" holds at equal Acc/Dec time only. At equal limits, the trapezoid of
// order 23, ramp 9, is better than the paper's order-40 Blackman-sinc. It is made of boxcars of 10 and 15 taps in
// series: peak 1/15, step 1/150. It needs less peak acceleration and jerk and takes 24 samples instead of 41. It has
// the smaller mean absolute deviation, hence corner error (Eq. 24). With both limits used fully, taps min((i + 1) j, a,
// (N + 1 - i) j), order 22 is enough (24 with zero end taps counted).
TEST(Shapes, TrapezoidBeatsThePapersFilterAtEqualLimits) {
  const Filter paper = blackman_sinc(40, 0.049);
  EXPECT_NEAR(mean_absolute_deviation(paper), 4.466, 5e-4);
  const Filter even = trapezoid(23, 9);
  EXPECT_NEAR(largest_tap(even), 1.0 / 15, 1e-15);
  EXPECT_NEAR(largest_step(even), 1.0 / 150, 1e-15);
  const double a = largest_tap(paper), j = largest_step(paper);
  std::vector<double> taps;
  for (int i = 0; i <= 22; ++i) taps.push_back(std::min({(i + 1) * j, a, (23 - i) * j}));
  const Filter saturated(taps);
  for (const Filter& f : {even, saturated}) {
    EXPECT_LE(largest_tap(f), a);
    EXPECT_LE(largest_step(f), j);
    EXPECT_LT(mean_absolute_deviation(f), mean_absolute_deviation(paper));
  }
  EXPECT_NEAR(mean_absolute_deviation(saturated), 4.12, 5e-3);
}

TEST(Shapes, RefuseArgumentsOutOfRange) {
  EXPECT_EQ(boxcar(0).order(), 0);
  EXPECT_EQ(trapezoid(0, 0).order(), 0);
  EXPECT_THROW(boxcar(-1), std::invalid_argument);
  EXPECT_THROW(trapezoid(-1, 0), std::invalid_argument);
  EXPECT_THROW(trapezoid(10, -1), std::invalid_argument);
  EXPECT_THROW(trapezoid(10, 6), std::invalid_argument);
  EXPECT_THROW(s_curve(1), std::invalid_argument);
  EXPECT_THROW(hann(1), std::invalid_argument);
  EXPECT_THROW(blackman(1), std::invalid_argument);
  EXPECT_THROW(blackman_sinc(1, 0.5), std::invalid_argument);
  EXPECT_THROW(blackman_sinc(40, 0.0), std::invalid_argument);
  EXPECT_THROW(blackman_sinc(40, 0.051), std::invalid_argument);
  EXPECT_THROW(blackman_sinc(40, std::nan("")), std::invalid_argument);
  EXPECT_NO_THROW(blackman_sinc(40, 0.05));
}

}  // namespace
}  // namespace accdec
