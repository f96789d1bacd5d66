#include <cmath>
#include <limits>
#include <stdexcept>

#include <gmock/gmock.h>

#include <accdec/comparison/performance_profile.hpp>

namespace accdec::comparison {
namespace {

using ::testing::DoubleEq;
using ::testing::ElementsAre;
constexpr double inf = std::numeric_limits<double>::infinity();

// Three problems by hand: A takes 1, 4 s and fails; B 2, 2 and 6 s. Ratios A: 1, 2, -; B: 2, 1, 1.
TEST(Profile, RatiosToTheFastestSolverOfEachProblem) {
  const auto r = performance_ratios({{1, 4, inf}, {2, 2, 6}});
  EXPECT_THAT(r[0], ElementsAre(1, 2, inf));
  EXPECT_THAT(r[1], ElementsAre(2, 1, 1));
  const Distribution a = distribution(r[0]), b = distribution(r[1]);
  EXPECT_THAT(a.x, ElementsAre(1, 2));
  EXPECT_THAT(a.y, ElementsAre(DoubleEq(1.0 / 3), DoubleEq(2.0 / 3)));
  EXPECT_THAT(b.x, ElementsAre(1, 2));
  EXPECT_THAT(b.y, ElementsAre(DoubleEq(2.0 / 3), DoubleEq(1.0)));
  EXPECT_EQ(at(a, 0.5), 0.0);
  EXPECT_DOUBLE_EQ(at(a, 1.0), 1.0 / 3);
  EXPECT_DOUBLE_EQ(at(a, 1.99), 1.0 / 3);
  EXPECT_DOUBLE_EQ(at(a, 1e9), 2.0 / 3) << "a failure is never made up for";
}

TEST(Profile, AProblemNobodySolvesStaysInTheDenominator) {
  const auto r = performance_ratios({{1, inf}, {3, inf}});
  EXPECT_THAT(r[0], ElementsAre(1, inf));
  EXPECT_DOUBLE_EQ(at(distribution(r[1]), 100), 0.5);
}

// A takes 2 s and its variant 1 s; B takes 3 s and 1 s. The variant takes no wins from A, and where it alone succeeds
// its ratio is 0.
TEST(Profile, RatiosToTheFastestOfSome) {
  const auto r = performance_ratios({{2, 2, inf}, {1, 1, 5}, {3, 1, inf}}, {0, 2});
  EXPECT_THAT(r[0], ElementsAre(1, 2, inf));
  EXPECT_THAT(r[1], ElementsAre(0.5, 1, 0));
  EXPECT_THAT(r[2], ElementsAre(1.5, 1, inf));
  EXPECT_DOUBLE_EQ(at(distribution(r[1]), 1.0), 1.0);
}

TEST(Profile, RefusesCostsThatAreNone) {
  EXPECT_THROW(performance_ratios({{1, 2}, {1}}), std::invalid_argument);
  EXPECT_THROW(performance_ratios({{0.0}}), std::invalid_argument);
  EXPECT_THROW(performance_ratios({{std::nan("")}}), std::invalid_argument);
  EXPECT_TRUE(performance_ratios({}).empty());
}

// 10 evaluations with 4 variables are 2 simplex gradients, 33 with 10 are 3.
TEST(Profile, DataProfileCountsSimplexGradients) {
  const auto g = simplex_gradients({10, 33, inf}, {4, 10, 2});
  EXPECT_THAT(g, ElementsAre(2, 3, inf));
  EXPECT_DOUBLE_EQ(at(distribution(g), 2.5), 1.0 / 3);
  EXPECT_THROW(simplex_gradients({1}, {1, 2}), std::invalid_argument);
}

TEST(Profile, TiesMakeOneStepAndTotalsMayBeLarger) {
  const Distribution d = distribution({3, 1, 3}, 6);
  EXPECT_THAT(d.x, ElementsAre(1, 3));
  EXPECT_THAT(d.y, ElementsAre(DoubleEq(1.0 / 6), DoubleEq(0.5)));
  EXPECT_THROW(distribution({1, 2}, 1), std::invalid_argument);
  EXPECT_EQ(at(distribution({}), 1.0), 0.0);
}

// Hyndman and Fan's type 7: of 1, 2, 3, 4 at 0.75, 1.5 and 2.25 steps from the first.
TEST(Profile, Quartiles) {
  const Quartiles q = quartiles({4, 1, 3, 2});
  EXPECT_DOUBLE_EQ(q.lower, 1.75);
  EXPECT_DOUBLE_EQ(q.median, 2.5);
  EXPECT_DOUBLE_EQ(q.upper, 3.25);
  EXPECT_EQ(quartiles({7}).lower, 7);
  EXPECT_EQ(quartiles({1, 2, inf}).median, 2);
  EXPECT_EQ(quartiles({1, 2, inf}).upper, inf);
  EXPECT_TRUE(std::isnan(quartiles({}).median));
}

}  // namespace
}  // namespace accdec::comparison
