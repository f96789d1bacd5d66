#include <numbers>

#include <gtest/gtest.h>

#include <accdec/certificate.hpp>
#include <accdec/exact/exact.hpp>

#include "support/tasks.hpp"

// Forgeries that live on what a checker grants rounding. Each claims that a task has no design, of a task that has one.

namespace accdec {
namespace {

/// A verified design's task with its delay given, so that one leaf can be about all filters.
Task with_delay_of_its_design(Task task) {
  const DesignResult result = design_exact(task);
  EXPECT_EQ(result.status, Status::optimal) << result.message;
  task.corners[0].delay = result.corners[0].delay;
  EXPECT_GT(*task.corners[0].delay, 0);
  return task;
}

/// "There is no design", by one leaf with these rows.
CheckReport check_refutation(const Task& task, const proof::Multipliers& rows) {
  DesignResult result;
  result.task = task;
  result.status = Status::infeasible;
  proof::BranchAndBound proof;
  proof.multipliers = {rows};
  proof.tree = {proof::Refuted{0}};
  result.certificate = std::make_shared<Certificate>(Certificate{proof});
  return check_certificate(task, result);
}

Task corner_with_speed(double speed_min) {
  Axis axis;
  axis.acceleration_max = 10.0;
  axis.jerk_max = 1500.0;
  Task task = testing::plane_task(axis, testing::plane_corner("A", 90, 0, 0.1, 0.1), 60e-6);
  task.corners[0].speed_min = speed_min;
  task.design.order_max = 40;
  return with_delay_of_its_design(task);
}

// Before leg 2 begins the motion is along leg 1, half a turn from the middle of this sector. So it is only a hair's
// breadth right of one edge and left of the other.
TEST(RoundingOfProofs, SectorsSeenFromBehindAreRejected) {
  const Task task = corner_with_speed(0.03);
  for (const double narrow : {1e-15, 5e-14, 4e-13}) {
    const double opposite = std::numbers::pi;
    const CheckReport report =
        check_refutation(task, {{proof::Speed{0, 1, opposite - narrow, opposite + narrow}, 1.0}});
    EXPECT_FALSE(report.accepted) << report.reason;
    EXPECT_NE(report.reason.find("does not hold all directions"), std::string::npos) << report.reason;
  }
}

// Sums of rows are not compared with a number but with zero: a proof may be scaled by any factor, and a forgery too.
TEST(RoundingOfProofs, TinyMultipliersAreNoConstantSpeed) {
  const Task task = corner_with_speed(0.0);
  for (const double multiplier : {1.0, 1e-200, 1e-299, 1e-303, 1e-308, 5e-324}) {
    proof::Multipliers rows;
    for (int k = 1; k <= task.design.order_max + *task.corners[0].delay + 1; ++k)
      rows.push_back({proof::Blend{LimitKind::acceleration, 0, 0, k, -1}, multiplier});
    EXPECT_FALSE(check_refutation(task, rows).accepted) << multiplier;
  }
}

// The same for limits that a leg at rest does not feel: of y on leg 1 there is nothing but a product with zero.
TEST(RoundingOfProofs, RowsOfLegsAtRestAreStillLeftOut) {
  Task task = corner_with_speed(0.0);
  DesignResult result = design_exact(task);
  ASSERT_EQ(result.status, Status::optimal);
  auto proof = std::get<proof::BranchAndBound>(result.certificate->proof);
  for (proof::Multipliers& rows : proof.multipliers)
    rows.push_back({proof::Blend{LimitKind::acceleration, 0, 1, 1, 1}, 1e3});  // leg 2 has not begun
  result.certificate = std::make_shared<Certificate>(Certificate{proof});
  const CheckReport report = check_certificate(task, result);
  EXPECT_TRUE(report.accepted) << report.reason;
}

}  // namespace
}  // namespace accdec
