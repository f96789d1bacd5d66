#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <accdec/families/trial_search.hpp>
#include <accdec/family.hpp>

namespace accdec {
namespace {

constexpr double never = std::numeric_limits<double>::infinity();

/// Standard deviation of the taps, samples.
double deviation(const Filter& filter) {
  double sum = 0.0;
  for (int i = 0; i <= filter.order(); ++i) sum += filter.tap(i) * std::pow(i - filter.mean_delay(), 2);
  return std::sqrt(sum);
}

// An order n has one boxcar and n/2 + 1 cascades of two averages. Three averages have as many as there are partitions
// of n into three parts >= 0: (n + 3)^2/12 to the nearest whole number.
TEST(Members, OfAnOrderAreVisitedOnce) {
  for (int order = 0; order <= 30; ++order) {
    for (const auto& [name, count] : {std::pair{"boxcar", 1},
                                      {"trapezoid", order / 2 + 1},
                                      {"averages", static_cast<int>(std::lround((order + 3) * (order + 3) / 12.0))}}) {
      const Family& family = *find_family(name);
      std::set<std::vector<int>> seen;
      visit_members(family, order, 1, [&](const FilterSpec& spec, std::span<const int> lengths) {
        EXPECT_TRUE(std::is_sorted(lengths.rbegin(), lengths.rend()));
        EXPECT_TRUE(seen.emplace(lengths.begin(), lengths.end()).second);
        const Filter filter = make_filter(spec);
        EXPECT_EQ(filter.order(), order);
        // Variances of averages of n taps, (n^2 - 1)/12, add up.
        double variance = 0.0;
        for (const int n : lengths) variance += (n * n - 1) / 12.0;
        EXPECT_NEAR(deviation(filter), std::sqrt(variance), 1e-9);
        EXPECT_EQ(family_of(spec), &family);
        return true;
      });
      EXPECT_EQ(static_cast<int>(seen.size()), count) << name << ", order " << order;
    }
  }
}

TEST(Members, WithPairsHaveEveryDelayThatFits) {
  const Family& family = *find_family("boxcar-zvd");
  std::vector<int> delays;
  visit_members(family, 9, 1, [&](const FilterSpec& spec, std::span<const int>) {
    EXPECT_EQ(make_filter(spec).order(), 9);
    delays.push_back(static_cast<int>(spec.pair_delay));
    return true;
  });
  EXPECT_THAT(delays, ::testing::ElementsAre(1, 2, 3, 4));
}

TEST(Members, AreThinnedOutAndStopWhenTold) {
  std::vector<int> second;
  const auto visit = [&](const FilterSpec&, std::span<const int> lengths) {
    second.push_back(lengths[1]);
    return second.size() < 5;
  };
  visit_members(*find_family("trapezoid"), 40, 7, visit);
  EXPECT_THAT(second, ::testing::ElementsAre(1, 2, 9, 16));
  second.clear();
  visit_members(*find_family("trapezoid"), 40, 1, visit);
  EXPECT_THAT(second, ::testing::ElementsAre(1, 2, 3, 4, 5));
}

// A convex cost of both lengths: the steps end at its minimum, and no member is asked for twice.
TEST(TrialSearch, FindsTheMinimumOfAConvexCost) {
  std::set<std::vector<double>> seen;
  const auto cost = [&](const Filter& filter) {
    EXPECT_TRUE(seen.emplace(filter.taps().begin(), filter.taps().end()).second);
    // The plateau is 1 over the longer length, the first tap 1 over both.
    const double longer = 1.0 / filter.tap(filter.order() / 2), shorter = 1.0 / (longer * filter.tap(0));
    return std::abs(longer - 37.0) + std::abs(shorter - 11.0);
  };
  TrialSearch search(*find_family("trapezoid"), {.order_min = 1, .order_max = 100}, cost);
  search.offer({20, 20});
  search.offer({80, 1});
  search.refine(6);
  EXPECT_THAT(search.best(), ::testing::ElementsAre(37, 11));
  EXPECT_NEAR(search.cost(), 0.0, 1e-9);
  EXPECT_EQ(search.tried(), static_cast<long>(seen.size()));
}

TEST(TrialSearch, KeepsItsBoundsAndStops) {
  int left = 3;
  TrialSearch search(
      *find_family("trapezoid"), {.order_min = 5, .order_max = 20, .keep_single = true},
      [&](const Filter& filter) { return --left, 100.0 - filter.order(); }, [&] { return left <= 0; });
  EXPECT_FALSE(search.offer({5, 1}));   // order 4
  EXPECT_FALSE(search.offer({15, 8}));  // order 21
  EXPECT_FALSE(search.offer({3, 4}));   // the longer one is first
  EXPECT_FALSE(search.found());
  EXPECT_EQ(search.cost(), never);
  EXPECT_TRUE(search.offer({12, 1}));
  EXPECT_FALSE(search.offer({12, 1}));
  search.refine(6);
  EXPECT_EQ(search.best()[1], 1);
  EXPECT_EQ(left, 0);
  EXPECT_EQ(search.tried(), 3);
}

}  // namespace
}  // namespace accdec
