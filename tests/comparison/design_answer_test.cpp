#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include <accdec/comparison/design_answer.hpp>
#include <accdec/comparison/external_answer.hpp>
#include <accdec/exact/exact.hpp>
#include <accdec/filter.hpp>
#include <accdec/verify.hpp>

#include "support/paths.hpp"

// Answers of others to whole designs.

namespace accdec {
namespace {

using comparison::DesignAnswer;
using comparison::read_names;
using comparison::replaced_violation;
using solvers::Claim;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class Answer : public ::testing::Test {
 protected:
  Answer() {
    task_ = read_task(test_support::source_folder() + "/problems/corner/acceleration-jerk.toml");
    task_.design.order_min = task_.design.order_max = 34;
    best_ = design_exact(task_);
    choice_ = instances::choice_of(task_, 34);
  }

  /// A point of the choice with these taps and this delay.
  std::vector<double> point(const Filter& filter, double delay) const {
    std::vector<double> x(choice_.start.size(), 0.0);
    for (int k = 1; k <= 34; ++k) x[static_cast<std::size_t>(k) - 1] = filter.cumulative(k);
    for (const auto& [variable, value] : choice_.delays[0].terms) {
      if (value == std::ceil(delay)) x[static_cast<std::size_t>(variable)] = delay / std::ceil(delay);
    }
    return x;
  }

  DesignAnswer judged(const Filter& filter, double delay, double most_violation = replaced_violation,
                      double seconds = 30.0) const {
    return comparison::judged_design(task_, choice_, point(filter, delay), most_violation, seconds);
  }

  Task task_;
  DesignResult best_;
  instances::Choice choice_;
};

TEST_F(Answer, IsJudgedBySimulation) {
  ASSERT_EQ(best_.status, Status::optimal) << best_.message;
  const int delay = best_.corners[0].delay;
  const DesignAnswer own = judged(*best_.filter, delay);
  ASSERT_TRUE(own.design);
  EXPECT_DOUBLE_EQ(own.design->objective(), best_.objective());
  EXPECT_EQ(own.design->corners[0].delay, delay);
  EXPECT_EQ(own.remark, "");
  // A longer delay holds, too, and costs what it costs.
  const DesignAnswer longer = judged(*best_.filter, delay + 1);
  ASSERT_TRUE(longer.design);
  EXPECT_NEAR(longer.design->objective() - best_.objective(), task_.sample_period, 1e-12);
}

TEST_F(Answer, TapsThatBreakALimitSlightlyAreReplacedAtItsDelays) {
  std::vector<double> taps;
  for (int i = 0; i <= 34; ++i) taps.push_back(best_.filter->tap(i) * (1.0 + 1e-7 * (i % 2 == 0 ? 1.0 : -1.0)));
  const DesignAnswer answer = judged(Filter(taps), best_.corners[0].delay);
  ASSERT_TRUE(answer.design) << answer.remark;
  EXPECT_DOUBLE_EQ(answer.design->objective(), best_.objective());
  EXPECT_GT(answer.violation, 1e-9);
  EXPECT_THAT(answer.remark, HasSubstr("others hold at its delays"));
  EXPECT_TRUE(verify_by_simulation(task_, *answer.design->filter, {best_.corners[0].delay}).feasible);
}

// The right delay alone is no answer: a boxcar breaks the limit on jerk many times over.
TEST_F(Answer, TapsThatBreakALimitByMoreThanToleranceAreRefused) {
  const int delay = best_.corners[0].delay;
  const DesignAnswer garbage = judged(boxcar(34), delay, comparison::replaced_violation_of_tangents);
  EXPECT_TRUE(garbage.whole);
  EXPECT_FALSE(garbage.design);
  EXPECT_GT(garbage.violation, 1.0);
  EXPECT_THAT(garbage.remark, HasSubstr("which no tolerance explains"));
  EXPECT_NEAR(comparison::replaced_violation_of_tangents, 1.0 / std::cos(std::numbers::pi / 64) - 1.0,
              replaced_violation);
}

TEST_F(Answer, NobodyIsBlamedWhereNoTimeIsLeftToJudge) {
  const DesignAnswer late = judged(boxcar(34), best_.corners[0].delay, 1e9, 0.0);
  EXPECT_FALSE(late.in_time);
  EXPECT_FALSE(late.design);
  EXPECT_EQ(late.remark, "not judged in time");
}

TEST_F(Answer, TooShortOrBrokenDelaysAreRefused) {
  const int delay = best_.corners[0].delay;
  const DesignAnswer shorter = judged(*best_.filter, delay - 1, 10.0);
  EXPECT_TRUE(shorter.whole);
  EXPECT_FALSE(shorter.design) << "shorter than proved";
  EXPECT_THAT(shorter.remark, HasSubstr("no filter found for its delays"));
  const DesignAnswer half = judged(*best_.filter, delay - 0.5);
  EXPECT_FALSE(half.whole);
  EXPECT_FALSE(half.design);
  EXPECT_THAT(half.remark, HasSubstr("delay of corner A is not whole"));
}

TEST(NamedValues, AreReadAsSolversWriteThem) {
  const auto cbc =
      read_names("Optimal - objective value 11.00000000\n      0 X1    0.5     1e-9\n      3 X4   1   0\n", 4);
  EXPECT_EQ(cbc.claim, Claim::solved);
  EXPECT_THAT(cbc.x, ElementsAre(0.5, 0.0, 0.0, 1.0));
  const auto glpsol = read_names(
      "Problem:    accdec\nStatus:     INTEGER OPTIMAL\n     1 R1    0.7   0\n     1 X1           0.25   0\n"
      "     2 X2    *      1     0     1\n",
      2);
  EXPECT_EQ(glpsol.claim, Claim::solved);
  EXPECT_THAT(glpsol.x, ElementsAre(0.25, 1.0));
  const auto highs = read_names("Model status\nOptimal\n\n# Columns 2\nX1 0.125\nX2 1\n# Dual\nX1 7\nX2 8\n", 2);
  EXPECT_EQ(highs.claim, Claim::solved);
  EXPECT_THAT(highs.x, ElementsAre(0.125, 1.0));
  const auto symphony = read_names("* Optimal Solution Found *\nSolution Cost: 11\nX2     0.5000\n", 2);
  EXPECT_EQ(symphony.claim, Claim::solved);
  EXPECT_THAT(symphony.x, ElementsAre(0.0, 0.5));
  EXPECT_EQ(read_names("# Objective value = 24\nX1 1\n", 1).claim, Claim::acceptable);
  EXPECT_EQ(read_names("Stopped on time limit - objective value 12\n0 X1 1 0\n", 1).claim, Claim::time_limit);
  EXPECT_EQ(read_names("Infeasible - objective value 0\n  0 X1 1 0\n", 1).claim, Claim::infeasible);
  EXPECT_TRUE(read_names("This problem is infeasible\n", 1).x.empty());
  EXPECT_EQ(read_names("Optimality not proven\nX1 1\n", 1).claim, Claim::acceptable);
  // The last word before the values counts, and options are no claims.
  EXPECT_EQ(read_names("presolve: no infeasible rows\noptimal solution found\nX1 1\n", 1).claim, Claim::solved);
  EXPECT_EQ(read_names("LP relaxation: optimal\nTime limit reached, gap 40 %\nX1 1\n", 1).claim, Claim::time_limit);
  EXPECT_EQ(read_names("Optimality tolerance 1e-6\nStopped: iteration limit\nX1 1\n", 1).claim, Claim::failed);
  EXPECT_EQ(read_names("Near-optimal\nX1 1\n", 1).claim, Claim::acceptable);
  EXPECT_EQ(read_names("SUBOPTIMAL\nX1 1\n", 1).claim, Claim::acceptable);
  EXPECT_EQ(read_names("No optimal solution found\nX1 1\n", 1).claim, Claim::failed);
  EXPECT_EQ(read_names("solution status: unbounded\n", 1).claim, Claim::unbounded);
}

// Words that leave open whether there is an answer deny none. The state of a point is none of the problem.
TEST(NamedValues, OnlyFirmWordsDenyAnAnswer) {
  const auto highs = read_names("Model status\nTime limit reached\n\n# Primal solution values\nInfeasible\n", 2);
  EXPECT_EQ(highs.claim, Claim::time_limit);
  EXPECT_EQ(read_names("Model status\nTime limit reached\n\n# Primal solution values\nInfeasible\nX1 1\n", 2).claim,
            Claim::time_limit);
  EXPECT_EQ(read_names("Model status\nInfeasible\n\n# Primal solution values\nNone\n\n# Dual solution values\n"
                       "Feasible\n",
                       2)
                .claim,
            Claim::infeasible);
  for (const char* open : {"Problem is infeasible or unbounded", "status: unbounded or infeasible",
                           "no feasible solution found, problem is not infeasible", "No feasible solution found",
                           "no optimal solution was found\nthe problem may be infeasible",
                           "infeasibility is possible: possibly infeasible", "Status: INFEASIBLE (INTERMEDIATE)"})
    EXPECT_EQ(read_names(std::string(open) + "\n", 2).claim, Claim::failed) << open;
  for (const char* firm : {"PROBLEM HAS NO FEASIBLE SOLUTION", "PROBLEM HAS NO INTEGER FEASIBLE SOLUTION",
                           "The problem is infeasible!", "Result - Problem proven infeasible",
                           "maybe infeasible or unbounded\nstatus: infeasible", "Status: INFEASIBLE (FINAL)"})
    EXPECT_EQ(read_names(std::string(firm) + "\n", 2).claim, Claim::infeasible) << firm;
  EXPECT_EQ(read_names("time limit reached, no feasible solution found\n", 2).claim, Claim::time_limit);
}

TEST(NamedValues, WrongOnesAreRefused) {
  EXPECT_THROW(read_names("X3 1\n", 2), std::invalid_argument);
  EXPECT_THROW(read_names("X99999999999999999999 1\nhello\n", 2), std::invalid_argument);
  EXPECT_THROW(read_names("optimal\nX1 0.5\nX2 1\nX1 0.7\n", 2), std::invalid_argument);
  EXPECT_THROW(read_names("", 2), std::invalid_argument);
  EXPECT_THROW(read_names("nothing that is known\n", 2), std::invalid_argument);
  EXPECT_TRUE(std::isnan(read_names("X1 nan\n", 1).x[0]));
  EXPECT_TRUE(std::isinf(read_names("X1 1e999\n", 1).x[0]));
  EXPECT_THAT(read_names("X1 1e-310\nX2 1e-999\n", 2).x, ElementsAre(1e-310, 0.0));
}

}  // namespace
}  // namespace accdec
