#include <gtest/gtest.h>

#include <accdec/task/objective.hpp>

#include "support/tasks.hpp"

namespace accdec {
namespace {

using testing::plane_corner;
using testing::plane_task;

Task two_corners() {
  Task task = plane_task({}, plane_corner("A", 90, 0, 0.1, 0.1), 1e-4);
  task.corners.push_back(plane_corner("B", 120, 0, 0.1, 0.1));
  task.corners[0].weight = 3.0;
  task.corners[1].weight = 0.5;
  task.sample_period = 2e-3;
  return task;
}

TEST(Objective, MachineTimePaysTheFilterOnceARun) {
  Task task = two_corners();
  task.design.runs = 4.0;
  // 4 (9 + 1) + 3 * 5 + 0.5 * 8 = 59 samples; each corner by itself 3 (10 + 5) + 0.5 (10 + 8) = 54.
  EXPECT_DOUBLE_EQ(cycle_time(task, 9, {5, 8}), 59 * 2e-3);
  EXPECT_DOUBLE_EQ(corner_time(task, 9, {5, 8}), 54 * 2e-3);
  EXPECT_DOUBLE_EQ(objective_time(task, 9, {5, 8}), 59 * 2e-3);
  task.design.objective = Objective::corner;
  EXPECT_DOUBLE_EQ(objective_time(task, 9, {5, 8}), 54 * 2e-3);
}

TEST(Objective, OfALoneCornerIsTheSame) {
  const Task task = plane_task({}, plane_corner("A", 90, 0, 0.1, 0.1), 1e-4);
  for (const int n : {0, 7, 40}) EXPECT_DOUBLE_EQ(cycle_time(task, n, {12}), corner_time(task, n, {12}));
}

TEST(Objective, CostsOfGivenDelaysAndWholeness) {
  Task task = two_corners();
  task.corners[0].delay = 7;
  EXPECT_DOUBLE_EQ(cost_of(task).given_delays(task), 21.0);
  EXPECT_FALSE(cost_of(task).whole());
  task.corners[1].weight = 2.0;
  EXPECT_TRUE(cost_of(task).whole());
  task.design.runs = 0.5;
  EXPECT_FALSE(cost_of(task).whole());
  EXPECT_TRUE(cost_of(task, Objective::corner).whole());
}

}  // namespace
}  // namespace accdec
