#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <set>
#include <stdexcept>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <accdec/filter.hpp>

namespace accdec {
namespace {

void expect_same(const Filter& a, const Filter& b, double tolerance) {
  ASSERT_EQ(a.order(), b.order());
  for (int i = 0; i <= a.order(); ++i) EXPECT_NEAR(a.tap(i), b.tap(i), tolerance) << "tap " << i;
}

std::complex<double> response(const Filter& filter, double phase) {
  std::complex<double> sum = 0.0;
  for (int i = 0; i <= filter.order(); ++i) sum += filter.tap(i) * std::polar(1.0, -phase * i);
  return sum;
}

// Two averages of ramp + 1 and order - ramp + 1 taps are the trapezoid; one average is the boxcar.
TEST(Averages, OneIsTheBoxcarTwoAreTheTrapezoid) {
  for (int order = 0; order <= 20; ++order) {
    const int one[] = {order + 1};
    expect_same(averages(one), boxcar(order), 1e-16);
    for (int ramp = 0; ramp <= order / 2; ++ramp) {
      const int two[] = {order - ramp + 1, ramp + 1};
      expect_same(averages(two), trapezoid(order, ramp), 1e-15);
    }
  }
}

// The response of a cascade is the product of the averages' Dirichlet kernels, and a pair multiplies it by cos(x
// delay/2).
TEST(Averages, ResponseIsTheProductOfTheirs) {
  const int lengths[] = {9, 5, 2};
  for (const int pairs : {0, 1, 2}) {
    const Filter filter = with_pairs(averages(lengths), pairs, 7);
    EXPECT_EQ(filter.order(), 8 + 4 + 1 + 7 * pairs);
    for (double x = 0.05; x < 3.1; x += 0.13) {
      double expected = std::pow(std::abs(std::cos(3.5 * x)), pairs);
      for (const int n : lengths) expected *= std::abs(std::sin(0.5 * n * x) / (n * std::sin(0.5 * x)));
      EXPECT_NEAR(std::abs(response(filter, x)), expected, 1e-14);
    }
  }
}

// Beside a convolution term by term in long double, which adds only: every tap to 1e-12 of itself, those at the ends
// too.
TEST(Averages, ManyStagesAreAsAccurateAtTheEndsAsInTheMiddle) {
  const std::vector<std::pair<int, std::size_t>> cascades{{3, 36}, {10, 18}, {10, 20}, {7, 60}, {500, 9}};
  for (const auto& [length, stages] : cascades) {
    std::vector<long double> expected{1.0L};
    for (std::size_t stage = 0; stage < stages; ++stage) {
      std::vector<long double> next(expected.size() + static_cast<std::size_t>(length) - 1, 0.0L);
      for (std::size_t i = 0; i < expected.size(); ++i) {
        for (std::size_t j = 0; j < static_cast<std::size_t>(length); ++j) next[i + j] += expected[i] / length;
      }
      expected = next;
    }
    const Filter filter = averages(std::vector<int>(stages, length));
    ASSERT_EQ(filter.taps().size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
      const auto tap = static_cast<double>(expected[i]);
      ASSERT_NEAR(filter.taps()[i], tap, 1e-12 * tap) << stages << " of " << length << ", tap " << i;
    }
  }
  EXPECT_DOUBLE_EQ(averages(std::vector<int>(20, 10)).tap(0), 1e-20);
}

// Averages of two taps give binomial coefficients over 2^n, here beyond the range of a double.
TEST(Averages, OfTwoTapsAreBinomialCoefficients) {
  const int n = 1100;
  const Filter filter = averages(std::vector<int>(n, 2));
  ASSERT_EQ(filter.order(), n);
  long double tap = std::ldexp(1.0L, -n);
  for (int i = 0; i <= n; ++i) {
    const auto expected = static_cast<double>(tap);
    ASSERT_NEAR(filter.tap(i), expected, std::max(1e-12 * expected, 1e-300)) << "tap " << i;
    tap *= static_cast<long double>(n - i) / (i + 1);
  }
}

// Lengths that come one after another in any order and shape of blocks.
TEST(Averages, OrderOfTheStagesDoesNotMatter) {
  const std::vector<int> rising{1, 2, 5, 40, 163}, falling{163, 40, 5, 2, 1};
  expect_same(averages(rising), averages(falling), 0.0);
}

TEST(Exponential, TapsAreAGeometricSeries) {
  const Filter filter = exponential(22, 0.93);
  const double first = (1.0 - 0.93) / (1.0 - std::pow(0.93, 23));
  for (int i = 0; i <= 22; ++i) EXPECT_NEAR(filter.tap(i), first * std::pow(0.93, i), 1e-15);
  expect_same(exponential(9, 1.0), boxcar(9), 1e-16);
  const Filter rising = exponential(22, 1.0 / 0.93);
  for (int i = 0; i <= 22; ++i) EXPECT_NEAR(rising.tap(i), filter.tap(22 - i), 1e-15);
}

TEST(Gaussian, IsSymmetricAndABoxcarAtAlphaZero) {
  expect_same(gaussian(9, 0.0), boxcar(9), 1e-16);
  const Filter filter = gaussian(10, 2.5);
  for (int i = 0; i <= 10; ++i) EXPECT_EQ(filter.tap(i), filter.tap(10 - i));
  // One standard deviation is 1/alpha of the half width of 5 samples: exp(-1/2) there.
  EXPECT_NEAR(filter.tap(7) / filter.tap(5), std::exp(-0.5), 1e-14);
}

TEST(ControllerShapes, RefuseWhatTheyCannotBe) {
  const int none[] = {3, 0};
  EXPECT_THROW(averages(none), std::invalid_argument);
  EXPECT_THROW(averages({}), std::invalid_argument);
  EXPECT_NO_THROW(averages(std::vector<int>(averages_max, 1)));
  EXPECT_THROW(averages(std::vector<int>(averages_max + 1, 1)), std::invalid_argument);
  // 2000 times an order of a million would take many seconds.
  EXPECT_THROW(averages(std::vector<int>(averages_max, 501)), std::invalid_argument);
  EXPECT_THROW(exponential(5, 0.0), std::invalid_argument);
  EXPECT_THROW(exponential(5, 1000.1), std::invalid_argument);
  EXPECT_THROW(gaussian(0, 1.0), std::invalid_argument);
  EXPECT_THROW(gaussian(5, 7.0), std::invalid_argument);
  EXPECT_THROW(with_pairs(boxcar(3), 1, 0), std::invalid_argument);
  EXPECT_THROW(with_pairs(boxcar(3), 3, 2), std::invalid_argument);
}

TEST(ShapeList, HoldsEveryShapeOnceAndMakesIt) {
  std::set<std::string_view> names;
  for (const ShapeInfo& shape : shape_list()) {
    EXPECT_TRUE(names.insert(shape.name).second) << shape.name;
    EXPECT_EQ(&info(shape.shape), &shape);
    EXPECT_EQ(shape_from_string(shape.name), shape.shape);
    FilterSpec spec;
    spec.kind = shape.shape;
    spec.order = 12;
    spec.cutoff = 0.05;
    spec.ramp = 3;
    spec.ratio = 0.9;
    spec.alpha = 2.0;
    spec.lengths = {8, 5, 2};
    spec.taps = std::vector<double>(13, 1.0);
    EXPECT_EQ(make_filter(spec).order(), 12) << shape.name;
    spec.pairs = 2;
    spec.pair_delay = 4;
    EXPECT_EQ(make_filter(spec).order(), 20) << shape.name;
  }
  EXPECT_EQ(shape_from_string("sinc"), std::nullopt);
}

/// The motion between samples is linear: behind an impulse between two of them it is what lies between their echoes.
TEST(Shapers, BetweenSamplesInterpolateTheMotion) {
  const Filter before = averages(std::vector{5, 3});
  for (const ShaperInfo& shaper : shaper_list()) {
    for (const double delay : {1.0, 3.25, 7.5, 9.999, 12.0}) {
      const Filter filter = with_pairs(before, shaper.pairs, delay, shaper.outer);
      const double end = shaper.pairs == 1 ? 0.5 : shaper.outer;
      EXPECT_EQ(filter.order(), 6 + static_cast<int>(std::ceil(shaper.pairs * delay)));
      EXPECT_NEAR(filter.mean_delay(), 3.0 + 0.5 * shaper.pairs * delay, 1e-12);
      const auto way = [&](double m) {
        const int whole = static_cast<int>(std::floor(m));
        return before.elapsed_moment(whole) +
               (m - whole) * (before.elapsed_moment(whole + 1) - before.elapsed_moment(whole));
      };
      for (int m = 0; m <= filter.order() + 1; ++m) {
        double sum = end * (way(m) + way(m - shaper.pairs * delay));
        if (shaper.pairs == 2) sum += (1.0 - 2.0 * end) * way(m - delay);
        EXPECT_NEAR(filter.elapsed_moment(m), sum, 1e-12) << shaper.name << " " << delay << " " << m;
      }
    }
  }
  EXPECT_EQ(with_pairs(before, 2, 4.0 + 1e-12).order(), with_pairs(before, 2, 4).order());
  EXPECT_THROW(with_pairs(before, 1, 0.75), std::invalid_argument);
  EXPECT_THROW(with_pairs(before, 3, 2.5), std::invalid_argument);
}

TEST(ShapeList, DescribesParameters) {
  FilterSpec spec;
  EXPECT_EQ(describe_parameters(spec), "");
  spec.kind = Shape::averages;
  spec.lengths = {19, 3};
  spec.pairs = 1;
  spec.pair_delay = 12;
  EXPECT_EQ(describe_parameters(spec), "lengths = [19, 3], ZV 12");
  spec.pair_delay = 12.345678901234;
  EXPECT_EQ(describe_parameters(spec), "lengths = [19, 3], ZV 12.3456789");
  EXPECT_EQ(describe_parameters(spec, Digits::all), "lengths = [19, 3], ZV 12.345678901234");
  spec.pairs = 0;
  spec.kind = Shape::exponential;
  spec.ratio = 0.95;
  EXPECT_EQ(describe_parameters(spec), "ratio = 0.95");
  spec.ratio = 0.9123456789;
  EXPECT_EQ(describe_parameters(spec), "ratio = 0.9123");
  EXPECT_EQ(describe_parameters(spec, Digits::all), "ratio = 0.9123456789");
}

TEST(ShapeList, TitlesSayWhatShapesAre) {
  EXPECT_EQ(shape_title(Shape::s_curve), "quintic S-curve (paper)");
  EXPECT_EQ(shape_title(Shape::trapezoid), "two averages (trapezoidal acceleration, the industry's S-curve)");
  EXPECT_EQ(shape_title(Shape::trapezoid, 2), "two averages, ZVD");
  EXPECT_EQ(shape_title(Shape::gaussian, 1), "Gaussian, ZV");
}

}  // namespace
}  // namespace accdec
