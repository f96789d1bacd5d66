#include <cmath>

#include <gtest/gtest.h>

#include <accdec/filter.hpp>
#include <accdec/task/equal_corners.hpp>
#include <accdec/verify.hpp>

#include "support/tasks.hpp"

namespace accdec {
namespace {

Axis plain_axis() {
  Axis axis;
  axis.mass = 30.0;
  axis.damping = 200.0;
  axis.acceleration_max = 5.0;
  axis.jerk_max = 400.0;
  axis.force_max = 150.0;
  axis.power_max = 12.0;
  axis.regeneration_max = 9.0;
  return axis;
}

TaskCorner corner_of(double angle, double heading, Turn turn) {
  TaskCorner corner("A", PlanarLegs{angle * M_PI / 180.0, heading * M_PI / 180.0, turn}, 0.1, 0.07);
  corner.error_max = 50e-6;
  corner.speed_min = 0.01;
  return corner;
}

Task task_of(const Axis& x, const Axis& y, const TaskCorner& corner) {
  Task task = testing::plane_task(x, corner, 50e-6);
  task.machine.axes = {x, y};
  return task;
}

// The simulation, which does not use symmetry, gives both the same error, speed and use of the limits.
TEST(EqualCorners, SimulateAlike) {
  const TaskCorner first = corner_of(70.0, 25.0, Turn::left);
  const Task one = task_of(plain_axis(), plain_axis(), first);
  for (const auto& [heading, turn] : {std::pair{25.0, Turn::left},
                                      {205.0, Turn::left},
                                      {115.0, Turn::left},
                                      {-25.0, Turn::right},
                                      {155.0, Turn::right},
                                      {65.0, Turn::right}}) {
    const TaskCorner second = corner_of(70.0, heading, turn);
    ASSERT_TRUE(ask_the_same(one.machine, first, second)) << heading;
    const Task other = task_of(plain_axis(), plain_axis(), second);
    for (const Filter& filter : {trapezoid(24, 7), Filter({1.0, 4.0, 2.0, 0.5, 0.25, 0.1})}) {
      for (const int delay : {0, 3, 11}) {
        std::vector<CornerResult> a, b;
        std::vector<LimitUse> used, uses;
        verify_by_simulation(one, filter, {delay}, &used, &a);
        verify_by_simulation(other, filter, {delay}, &uses, &b);
        EXPECT_NEAR(a[0].corner_error, b[0].corner_error, 1e-13);
        EXPECT_NEAR(a[0].speed_min, b[0].speed_min, 1e-13);
        const auto most = [](const std::vector<LimitUse>& all, LimitKind kind) {
          double value = 0.0;
          for (const LimitUse& use : all) value = use.kind == kind ? std::max(value, use.utilisation) : value;
          return value;
        };
        for (const LimitKind kind :
             {LimitKind::acceleration, LimitKind::jerk, LimitKind::force, LimitKind::power, LimitKind::regeneration})
          EXPECT_NEAR(most(used, kind), most(uses, kind), 1e-9 * most(used, kind));
      }
    }
  }
}

TEST(EqualCorners, WhatDiffersIsNotMerged) {
  const TaskCorner first = corner_of(70.0, 25.0, Turn::left);
  Task task = task_of(plain_axis(), plain_axis(), first);
  EXPECT_FALSE(ask_the_same(task.machine, first, corner_of(70.0, 26.0, Turn::left)));
  EXPECT_FALSE(ask_the_same(task.machine, first, corner_of(70.0 + 1e-9, 25.0, Turn::left)));
  EXPECT_FALSE(ask_the_same(task.machine, first, corner_of(70.0, 25.0, Turn::right)));
  TaskCorner other = first;
  other.error_max = 50.000001e-6;
  EXPECT_FALSE(ask_the_same(task.machine, first, other));
  other = first, other.error_max.reset();
  EXPECT_FALSE(ask_the_same(task.machine, first, other));
  other = first, other.speed_min = 0.02;
  EXPECT_FALSE(ask_the_same(task.machine, first, other));
  other = first, other.delay = 4;
  EXPECT_FALSE(ask_the_same(task.machine, first, other));
  other = first, other.set_feeds(0.07, 0.1);
  EXPECT_FALSE(ask_the_same(task.machine, first, other));
  // Exchanged axes with unequal limits.
  const TaskCorner turned = corner_of(70.0, 115.0, Turn::left);
  ASSERT_TRUE(ask_the_same(task.machine, first, turned));
  task.machine.axes[1].force_max *= 1.0 + 1e-9;
  EXPECT_FALSE(ask_the_same(task.machine, first, turned));
  EXPECT_TRUE(ask_the_same(task.machine, first, corner_of(70.0, 205.0, Turn::left)));
}

TEST(EqualCorners, AreOneWithAllTheirWeight) {
  Task task = task_of(plain_axis(), plain_axis(), corner_of(70.0, 25.0, Turn::left));
  task.corners.push_back(corner_of(95.0, 0.0, Turn::left));
  task.corners.push_back(corner_of(70.0, 205.0, Turn::left));
  task.corners.push_back(corner_of(95.0, 90.0, Turn::left));
  for (std::size_t j = 0; j < 4; ++j) task.corners[j].weight = static_cast<double>(1 << j);
  const MergedTask merged = merge_equal_corners(task);
  ASSERT_EQ(merged.task.corners.size(), 2u);
  EXPECT_EQ(merged.of, (std::vector<int>{0, 1, 0, 1}));
  EXPECT_EQ(merged.task.corners[0].weight, 5.0);
  EXPECT_EQ(merged.task.corners[1].weight, 10.0);
  EXPECT_EQ(merged.expand({7, 9}), (std::vector<int>{7, 9, 7, 9}));
}

}  // namespace
}  // namespace accdec
