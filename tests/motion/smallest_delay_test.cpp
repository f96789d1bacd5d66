#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include <accdec/corner.hpp>

#include "support/random_case.hpp"
#include "support/tries.hpp"

namespace accdec {
namespace {

using test::integer;
using test::log_uniform;
using test::Random;
using test::random_filter;
using test::uniform;

/// min_k |S[k]| from the definition: every sample, position from tap sums, law of cosines.
double plain_error(const Filter& in, const Filter& out, double c, double step_in, double step_out, int d) {
  double best = std::numeric_limits<double>::infinity();
  for (int k = 0; k <= std::max(in.order(), out.order() + d) + 1; ++k) {
    const double p = in.remaining_moment(k) * step_in, q = out.elapsed_moment(k - d) * step_out;
    best = std::min(best, (p - q) * (p - q) + 2.0 * p * q * (1.0 + c));
  }
  return std::sqrt(best);
}

struct Case {
  double c, step_in, step_out, error_max;
};

Case random_corner(Random& random, const Filter& in) {
  const double pi = std::numbers::pi;
  double angle = 0.0;
  switch (integer(random, 0, 5)) {
    case 0: angle = log_uniform(random, 1e-6, 0.02); break;       // needle
    case 1: angle = pi - log_uniform(random, 1e-9, 0.02); break;  // nearly straight
    case 2: angle = integer(random, 1, 12) * pi / 12.0; break;    // round angles, 90 and 180 among them
    default: angle = uniform(random, 0.01, pi);
  }
  Case corner{std::cos(angle), log_uniform(random, 1e-6, 1e-2), 0.0, 0.0};
  corner.step_out = integer(random, 0, 2) == 0 ? corner.step_in : corner.step_in * log_uniform(random, 0.02, 50.0);
  // From far below a sample's step to beyond the error without delay.
  const double scale = std::max(1.0, in.mean_delay()) * corner.step_in;
  corner.error_max = integer(random, 0, 30) == 0 ? 0.0 : scale * log_uniform(random, 1e-9, 2.0);
  return corner;
}

/// The answer must be feasible, and no smaller delay may be, ties by rounding (1e-12 of the bound) excepted.
void expect_smallest(const Filter& in, const Filter& out, const Case& corner) {
  const int d = DelayFinder(in, out)(corner.c, corner.step_in, corner.step_out, corner.error_max);
  ASSERT_GE(d, 0);
  ASSERT_LE(plain_error(in, out, corner.c, corner.step_in, corner.step_out, d), corner.error_max);
  for (int smaller = 0; smaller < d; ++smaller) {
    const double error = plain_error(in, out, corner.c, corner.step_in, corner.step_out, smaller);
    ASSERT_GT(error, corner.error_max * (1.0 - 1e-12))
        << "delay " << smaller << " does, " << d << " was returned; cos " << corner.c << " steps " << corner.step_in
        << " " << corner.step_out << " bound " << corner.error_max << " orders " << in.order() << " " << out.order();
  }
}

TEST(SmallestDelay, EqualsBruteForceOneFilter) {
  Random random(1);
  for (int i = 0; i < test_support::tries(400000); ++i) {
    const Filter filter = random_filter(random, i % 500 == 0 ? 300 : 40);
    expect_smallest(filter, filter, random_corner(random, filter));
    if (HasFatalFailure()) return;
  }
}

TEST(SmallestDelay, EqualsBruteForcePairs) {
  Random random(2);
  for (int i = 0; i < test_support::tries(200000); ++i) {
    const Filter in = random_filter(random, i % 500 == 0 ? 300 : 40),
                 out = random_filter(random, i % 300 == 0 ? 300 : 40);
    expect_smallest(in, out, random_corner(random, in));
    if (HasFatalFailure()) return;
  }
}

// A bound that is the error of some delay, but for rounding, is met by that delay, not by the next.
TEST(SmallestDelay, TiesAreMetNotMissed) {
  Random random(3);
  for (int i = 0; i < test_support::tries(50000); ++i) {
    const Filter filter = random_filter(random, 40);
    Case corner = random_corner(random, filter);
    const int d = integer(random, 0, filter.order());
    corner.error_max = plain_error(filter, filter, corner.c, corner.step_in, corner.step_out, d) * (1 + 1e-12);
    ASSERT_LE(DelayFinder(filter)(corner.c, corner.step_in, corner.step_out, corner.error_max), d);
  }
}

TEST(SmallestDelay, ZeroToleranceIsTheExactStop) {
  // Taps 2 .. 5 of 0 .. 7: leg 1 stands still from sample 5 on, leg 2 up to 2 samples after its command.
  const Filter filter({0, 0, 1, 2, 1, 1, 0, 0});
  const DelayFinder finder(filter);
  EXPECT_EQ(finder.exact_stop_delay(), 3);
  for (double angle : {1.0, 60.0, 90.0, 135.0, 179.0}) {
    EXPECT_EQ(finder(std::cos(angle * std::numbers::pi / 180.0), 1e-4, 3e-4, 0.0), 3) << angle;
  }
  EXPECT_EQ(DelayFinder(boxcar(40))(0.0, 1e-4, 1e-4, 0.0), 40);
  // A pure delay moves both legs alike and blunts no corner.
  EXPECT_EQ(DelayFinder(Filter({0, 0, 0, 1}))(0.0, 1e-4, 1e-4, 0.0), 0);
  // Leg 1's filter shorter than leg 2's dead time: leg 2 starts after leg 1 has ended without any command delay.
  EXPECT_EQ(DelayFinder(Filter({1, 1}), Filter({0, 0, 0, 1, 1}))(0.0, 1e-4, 1e-4, 0.0), 0);
}

TEST(SmallestDelay, AnyToleranceAboveTheUndelayedErrorNeedsNone) {
  const DelayFinder finder(boxcar(40));
  EXPECT_EQ(finder(-0.5, 1e-4, 1e-4, std::numeric_limits<double>::infinity()), 0);
  EXPECT_EQ(finder(-0.5, 1e-4, 1e-4, 1e300), 0);
  EXPECT_EQ(finder(-1.0, 1e-4, 1e-4, 1e-4), 0);  // straight on at one feed: a sample in every step's length
}

// For a boxcar with equal feeds and N + d even, eps = 2 v0 T cos(theta/2) E[max(i - N/2 - d/2, 0)]. With j = (N - d)/2
// taps left of N + 1, the sum is j (j + 1) / (2 (N + 1)). The bound is put just above and just below it.
TEST(SmallestDelay, BoxcarInClosedForm) {
  const int order = 40;
  const DelayFinder finder(boxcar(order));
  const double step = 1e-4, angle = 1.2;
  for (int j = 1; j <= order / 2; ++j) {
    const int d = order - 2 * j;
    const double error = step * std::cos(angle / 2) * j * (j + 1.0) / (order + 1.0);
    EXPECT_EQ(finder(std::cos(angle), step, step, error * (1 + 1e-9)), d) << j;
    EXPECT_EQ(finder(std::cos(angle), step, step, error * (1 - 1e-9)), d + 1) << j;
  }
}

}  // namespace
}  // namespace accdec
