// The module of Bonmin is no part of the build unless it is asked for. Its source is tested here by itself.

#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <accdec/comparison/design_answer.hpp>
#include <accdec/design.hpp>
#include <accdec/instances/instance.hpp>
#include <accdec/solvers/registration.hpp>
#include <accdec/task.hpp>

namespace accdec {
namespace {

/// One corner at 4 ms, to be designed at one order.
Task small_task(int order) {
  Task task = parse_task(R"(
sample_period_ms = 4.0
[[axis]]
acceleration_max_mm_s2 = 6000
jerk_max_mm_s3 = 500000
[[corner]]
angle_deg = 75
heading_deg = 20
feed_in_mm_min = 6000
feed_out_mm_min = 4000
error_max_um = 60
)",
                         "small");
  task.design.order_min = task.design.order_max = order;
  return task;
}

solvers::Result by_outer_approximation(const instances::Choice& choice) {
  solvers::SolverList list;
  accdec_add_solvers(list);
  EXPECT_THAT(list, testing::SizeIs(2));
  EXPECT_EQ(list.back()->name(), "bonmin-oa");
  solvers::Options options;
  options.time_limit = 120.0;
  return list.back()->solve(choice.problem, choice.start, options);
}

// Two methods that share no step. The exact one branches on delays and samples, with linear programs. Outer
// approximation has Cbc choose them, with tangents at Ipopt's points.
TEST(BonminOuterApproximation, FindsTheOptimaOfTheExactMethod) {
  for (const int order : {8, 11}) {
    const Task task = small_task(order);
    const DesignResult exact = design_task(task);
    ASSERT_EQ(exact.status, Status::optimal);
    const int delay = exact.corners.front().delay;
    EXPECT_GT(delay, 0);
    const instances::Choice choice = instances::choice_of(task, order);
    const solvers::Result result = by_outer_approximation(choice);
    ASSERT_EQ(result.claim, solvers::Claim::solved) << result.message;
    EXPECT_NEAR(choice.delays.front()(result.x), delay, 1e-3);
    EXPECT_NEAR(result.claimed_objective, order + 1 + delay, 1e-3);
    const comparison::DesignAnswer judged =
        comparison::judged_design(task, choice, result.x, comparison::replaced_violation);
    ASSERT_TRUE(judged.design) << judged.remark;
    EXPECT_EQ(judged.design->corners.front().delay, delay);
  }
}

// 6 m/s^2 over 4 ms lets a tap be 0.24 of the larger feed at most. Four taps do not reach it.
TEST(BonminOuterApproximation, FindsThatTooFewTapsReachNoFeed) {
  const Task task = small_task(3);
  EXPECT_EQ(design_task(task).status, Status::infeasible);
  EXPECT_EQ(by_outer_approximation(instances::choice_of(task, 3)).claim, solvers::Claim::infeasible);
}

}  // namespace
}  // namespace accdec
