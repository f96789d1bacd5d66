#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <accdec/filter.hpp>

#include "support/random_case.hpp"

namespace accdec {
namespace {

using test::integer;
using test::Random;
using test::random_filter;

// A result is written, read and verified: its taps must come back to the last bit.
TEST(Filter, NormalisingTwiceChangesNothing) {
  Random random(5);
  for (int i = 0; i < 2000; ++i) {
    const Filter once = random_filter(random, 300);
    const Filter twice(std::vector<double>(once.taps().begin(), once.taps().end()));
    EXPECT_TRUE(std::equal(once.taps().begin(), once.taps().end(), twice.taps().begin(), twice.taps().end())) << i;
  }
}

TEST(Filter, SequencesEqualTheirDefinitions) {
  Random random(1);
  for (int i = 0; i < 300; ++i) {
    const Filter f = random_filter(random, 60);
    const int n = f.order();
    double sum = 0.0;
    for (double b : f.taps()) sum += b;
    EXPECT_NEAR(sum, 1.0, 1e-14);
    EXPECT_EQ(f.cumulative(0), 0.0);
    EXPECT_EQ(f.cumulative(n + 1), 1.0);
    for (int k = -3; k <= n + 4; ++k) {
      long double cumulative = 0, elapsed = 0, left = 0;
      for (int j = 0; j <= n; ++j) {
        const long double b = f.tap(j);
        if (j < k) cumulative += b;
        elapsed += b * std::max(k - j, 0);
        left += b * std::max(j - k, 0);
      }
      EXPECT_NEAR(f.cumulative(k), static_cast<double>(cumulative), 1e-14);
      EXPECT_NEAR(f.remaining(k), static_cast<double>(1 - cumulative), 1e-14);
      EXPECT_NEAR(f.elapsed_moment(k), static_cast<double>(elapsed), 1e-14 * (n + 4));
      EXPECT_NEAR(f.remaining_moment(k), static_cast<double>(left), 1e-14 * (n + 4));
      // Distance gone less distance left is the time since the mean delay.
      EXPECT_NEAR(f.elapsed_moment(k) - f.remaining_moment(k), k - f.mean_delay(), 1e-13 * (n + 4));
    }
  }
}

TEST(Filter, EndsAreExactlyAtRest) {
  const Filter f({0, 0, 1, 3, 2, 0, 0, 0});
  EXPECT_EQ(f.first_nonzero_tap(), 2);
  EXPECT_EQ(f.last_nonzero_tap(), 4);
  EXPECT_EQ(f.elapsed_moment(2), 0.0);
  EXPECT_GT(f.elapsed_moment(3), 0.0);
  EXPECT_EQ(f.remaining_moment(4), 0.0);
  EXPECT_GT(f.remaining_moment(3), 0.0);
  EXPECT_EQ(f.remaining(5), 0.0);
  EXPECT_EQ(f.tap(-1), 0.0);
  EXPECT_EQ(f.tap(8), 0.0);
}

TEST(Filter, ScaleOfTheTapsDoesNotMatter) {
  const Filter one({1, 2, 5, 3});
  for (double scale : {0.5, 1e-300, 1e300, 4096.0}) {
    const Filter scaled({1 * scale, 2 * scale, 5 * scale, 3 * scale});
    for (int i = 0; i < 4; ++i) EXPECT_DOUBLE_EQ(scaled.tap(i), one.tap(i));
    EXPECT_DOUBLE_EQ(scaled.mean_delay(), (2 + 10 + 9) / 11.0);
  }
  const double largest = std::numeric_limits<double>::max(), least = std::numeric_limits<double>::denorm_min();
  EXPECT_DOUBLE_EQ(Filter({largest, largest, largest}).tap(1), 1.0 / 3);
  EXPECT_DOUBLE_EQ(Filter({least, least}).tap(1), 0.5);
}

TEST(Filter, AppendedZeroTapsChangeNothingPrependedOnesShift) {
  Random random(2);
  for (int i = 0; i < 100; ++i) {
    const Filter f = random_filter(random, 30);
    std::vector<double> padded(f.taps().begin(), f.taps().end()), shifted(3, 0.0);
    padded.resize(padded.size() + 5, 0.0);
    shifted.insert(shifted.end(), f.taps().begin(), f.taps().end());
    const Filter p(padded), s(shifted);
    for (int k = -2; k <= f.order() + 8; ++k) {
      EXPECT_NEAR(p.cumulative(k), f.cumulative(k), 1e-15);
      EXPECT_NEAR(p.elapsed_moment(k), f.elapsed_moment(k), 1e-13);
      EXPECT_NEAR(p.remaining_moment(k), f.remaining_moment(k), 1e-13);
      EXPECT_NEAR(s.elapsed_moment(k + 3), f.elapsed_moment(k), 1e-13);
      EXPECT_NEAR(s.remaining_moment(k + 3), f.remaining_moment(k), 1e-13);
    }
    EXPECT_EQ(s.first_nonzero_tap(), f.first_nonzero_tap() + 3);
    EXPECT_EQ(p.last_nonzero_tap(), f.last_nonzero_tap());
  }
}

TEST(Filter, ReversedTapsSwapStopAndStart) {
  Random random(3);
  for (int i = 0; i < 100; ++i) {
    const Filter f = random_filter(random, 30);
    const Filter r(std::vector<double>(f.taps().rbegin(), f.taps().rend()));
    for (int k = -2; k <= f.order() + 2; ++k) {
      EXPECT_NEAR(f.remaining_moment(k), r.elapsed_moment(f.order() - k), 1e-13);
      EXPECT_NEAR(f.remaining(k), r.cumulative(f.order() + 1 - k), 1e-15);
    }
  }
}

TEST(Filter, RefusesBadTaps) {
  const double nan = std::nan(""), inf = HUGE_VAL;
  EXPECT_THROW(Filter({}), std::invalid_argument);
  EXPECT_THROW(Filter({0, 0}), std::invalid_argument);
  EXPECT_THROW(Filter({1, nan}), std::invalid_argument);
  EXPECT_THROW(Filter({1, inf}), std::invalid_argument);
  try {
    Filter({1, 2, -0.5});
    FAIL();
  } catch (const std::invalid_argument& e) {
    EXPECT_THAT(e.what(), testing::HasSubstr("b_2 = -0.5 is negative"));
  }
}

}  // namespace
}  // namespace accdec
