#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include <accdec/families/cascade.hpp>
#include <accdec/filter.hpp>

namespace accdec {
namespace {

struct Drawn {
  std::vector<int> lengths;
  int pairs, pair_delay;
};

Drawn draw(std::mt19937& rng, int longest) {
  const auto whole = [&](int low, int high) { return std::uniform_int_distribution<int>(low, high)(rng); };
  Drawn drawn;
  for (int i = whole(1, 3); i > 0; --i) drawn.lengths.push_back(whole(1, longest));
  drawn.pairs = whole(0, 2);
  drawn.pair_delay = whole(1, longest);
  return drawn;
}

Filter filter_of(const Drawn& drawn) {
  return Filter(cascade_taps(drawn.lengths, drawn.pairs, drawn.pair_delay));
}

// Sample by sample against the taps themselves, which are made by running sums.
TEST(Cascade, TapsAndTheirSumsAreThoseOfTheTaps) {
  std::mt19937 rng(1);
  for (int trial = 0; trial < 300; ++trial) {
    const Drawn drawn = draw(rng, trial < 200 ? 12 : 400);
    const Filter filter = filter_of(drawn);
    const Cascade cascade(drawn.lengths, drawn.pairs, drawn.pair_delay);
    ASSERT_EQ(cascade.order(), filter.order());
    for (int k = -2; k <= filter.order() + 2; ++k) {
      const double tap = filter.tap(k);
      EXPECT_NEAR(cascade.tap(k), tap, tap > 0.0 ? 1e-9 * tap : 1e-14);  // nothing between impulses but rounding
      EXPECT_NEAR(cascade.gone(k), filter.cumulative(k + 1), 1e-9);
      double before = 0.0, after = 0.0;
      for (int i = 0; i <= filter.order(); ++i) {
        before += filter.tap(i) * std::max(k - i, 0);
        after += filter.tap(i) * std::max(i - k, 0);
      }
      EXPECT_NEAR(cascade.elapsed(k), before, 1e-9 * before + 1e-13);
      EXPECT_NEAR(cascade.remaining(k), after, 1e-9 * after + 1e-13);
    }
  }
}

// Computes the error sample by sample at every delay up to one. If any of these delays is allowed, nothing must be
// refused. Up to 90 degrees, where the error falls with the delay, it must be refused in all other cases.
TEST(Cascade, ErrorsAreRefusedOnlyWhereNoDelayHoldsThem) {
  std::mt19937 rng(2);
  int refused = 0, held = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const Drawn drawn = draw(rng, 12);
    const Filter filter = filter_of(drawn);
    const Cascade cascade(drawn.lengths, drawn.pairs, drawn.pair_delay);
    const double cosine = std::uniform_real_distribution<double>(-1.0, 0.99)(rng);
    const double in = 1.0, out = std::uniform_real_distribution<double>(0.3, 3.0)(rng);
    const double allowed = std::uniform_real_distribution<double>(0.0, 0.4 * filter.order() + 0.1)(rng);
    double least = 1e9;
    for (int d = 0; d <= filter.order(); ++d) {
      for (int k = 0; k <= filter.order() + d; ++k) {
        double p = 0.0, q = 0.0;
        for (int i = 0; i <= filter.order(); ++i) {
          p += in * filter.tap(i) * std::max(i - k, 0);
          q += out * filter.tap(i) * std::max(k - d - i, 0);
        }
        least = std::min(least, std::sqrt(std::max(0.0, p * p + q * q + 2.0 * p * q * cosine)));
      }
      const bool may = may_hold_error(cascade, cosine, in, out, d, allowed);
      if (least <= allowed * (1.0 - 1e-9)) {
        EXPECT_TRUE(may) << trial << ", delay " << d;
      }
      if (cosine >= 0.0 && least > allowed * (1.0 + 1e-7)) {
        EXPECT_FALSE(may) << trial << ", delay " << d;
      }
      ++(may ? held : refused);
    }
  }
  EXPECT_GT(refused, 300);
  EXPECT_GT(held, 300);
}

}  // namespace
}  // namespace accdec
