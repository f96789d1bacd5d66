#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <set>

#include <gmock/gmock.h>

#include <accdec/study/point_set.hpp>

namespace accdec::study {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

Variation list(const std::string& name, std::vector<double> values) {
  return {name, {name}, std::move(values), false, false};
}

TEST(PointSet, GridHasEveryCombinationOnceFirstVariationSlowest) {
  const PointSet plan({"a", "b"}, {list("u", {1, 2, 3}), list("v", {10, 20})});
  ASSERT_EQ(plan.size(), 12u);
  EXPECT_THAT(plan.point(0).values, ElementsAre(1, 10));
  EXPECT_THAT(plan.point(1).values, ElementsAre(1, 20));
  EXPECT_THAT(plan.point(5).values, ElementsAre(3, 20));
  EXPECT_EQ(plan.point(5).case_index, 0u);
  EXPECT_EQ(plan.point(6).case_index, 1u);
  std::set<std::pair<std::size_t, std::vector<double>>> seen;
  for (std::size_t i = 0; i < plan.size(); ++i) seen.insert({plan.point(i).case_index, plan.point(i).values});
  EXPECT_EQ(seen.size(), 12u);
  EXPECT_THROW(plan.point(12), std::out_of_range);
}

TEST(PointSet, LatinHypercubePutsOnePointIntoEveryStratumOfEveryAxis) {
  const std::size_t n = 37;
  const PointSet plan({""}, {{"u", {"u"}, {2.0, 5.0}, true, false}, {"v", {"v"}, {1.0, 1000.0}, true, true}},
                      Sampling::latin_hypercube, n, 11);
  ASSERT_EQ(plan.size(), n);
  std::set<int> u, v;
  for (std::size_t i = 0; i < n; ++i) {
    const auto p = plan.point(i).values;
    u.insert(static_cast<int>(std::floor((p[0] - 2.0) / 3.0 * n)));
    v.insert(static_cast<int>(std::floor(std::log10(p[1]) / 3.0 * n)));
  }
  EXPECT_EQ(u.size(), n);
  EXPECT_EQ(v.size(), n);
  EXPECT_EQ(*u.begin(), 0);
  EXPECT_EQ(*v.rbegin(), static_cast<int>(n) - 1);
}

TEST(PointSet, LatinHypercubeSpreadsListsEvenlyAndFollowsItsSeed) {
  const auto make = [](std::uint64_t seed) {
    return PointSet({""}, {list("u", {1, 2, 3})}, Sampling::latin_hypercube, 30, seed);
  };
  const PointSet a = make(1), b = make(1), c = make(2);
  int count[4] = {};
  bool same = true, other = false;
  for (std::size_t i = 0; i < 30; ++i) {
    ++count[static_cast<int>(a.point(i).values[0])];
    same = same && a.point(i).values == b.point(i).values;
    other = other || a.point(i).values != c.point(i).values;
  }
  EXPECT_THAT(count, ElementsAre(0, 10, 10, 10));
  EXPECT_TRUE(same);
  EXPECT_TRUE(other);
}

TEST(PointSet, RangesHaveExactEnds) {
  EXPECT_THAT(spread(1, 2, 3, false), ElementsAre(1, 1.5, 2));
  const auto log = spread(1, 1000, 4, true);
  EXPECT_NEAR(log[1], 10, 1e-12);
  EXPECT_EQ(log.back(), 1000);
  EXPECT_THAT(spread(7, 9, 1, false), ElementsAre(7));
  EXPECT_THROW(spread(0, 1, 3, true), std::invalid_argument);
  EXPECT_THROW(spread(0, 1, 0, false), std::invalid_argument);
}

TEST(PointSet, RefusesWhatHasNoPoints) {
  EXPECT_THAT([] { PointSet({"a"}, {list("u", {})}); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("`u` has no values")));
  EXPECT_THAT([] { PointSet({}, {}); }, ThrowsMessage<std::invalid_argument>(HasSubstr("case")));
  EXPECT_THAT(
      [] {
        PointSet({"a"}, {list("u", {1}), list("u", {1})});
      },
      ThrowsMessage<std::invalid_argument>(HasSubstr("two")));
  EXPECT_THROW(PointSet({"a"}, {list("u", {1})}, Sampling::latin_hypercube, 0), std::invalid_argument);
}

}  // namespace
}  // namespace accdec::study
