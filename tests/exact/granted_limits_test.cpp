#include <cmath>

#include <gtest/gtest.h>

#include <accdec/certificate.hpp>
#include <accdec/exact/exact.hpp>
#include <accdec/filter.hpp>
#include <accdec/verify.hpp>

#include "support/tasks.hpp"

// `optimal` is about everything that verification would accept, so also about limits held to a part in 10^9 only.

namespace accdec {
namespace {

using testing::plane_corner;
using testing::plane_task;

/// Twenty taps of a twentieth are the shortest filter, and the only one of their order, if `part` of what they
/// accelerate with is allowed.
Task twenty_taps(double part, double interior = 180.0, std::optional<double> tolerance = std::nullopt) {
  Axis axis;
  axis.acceleration_max = part * 0.1 / (20 * 1e-3);
  Task task = plane_task(axis, plane_corner("A", interior, 0, 0.1, 0.1), tolerance);
  task.design.order_max = 60;
  return task;
}

TEST(GrantedLimits, AThresholdWithinTheToleranceIsReached) {
  for (const double part : {1.0, 1.0 - 1e-12, 1.0 - 5e-10}) {
    const Task task = twenty_taps(part);
    ASSERT_TRUE(verify_by_simulation(task, boxcar(19), {0}).feasible);
    const DesignResult result = design_exact(task);
    EXPECT_EQ(result.status, Status::optimal) << part << result.message;
    ASSERT_TRUE(result.filter);
    EXPECT_EQ(result.filter->order(), 19) << part;
    EXPECT_TRUE(check_certificate(task, result).accepted);
  }
}

TEST(GrantedLimits, AThresholdBeyondItIsNot) {
  const Task task = twenty_taps(1.0 - 1e-8);
  ASSERT_FALSE(verify_by_simulation(task, boxcar(19), {0}).feasible);
  const DesignResult result = design_exact(task);
  EXPECT_EQ(result.status, Status::optimal) << result.message;
  EXPECT_EQ(result.filter->order(), 20);
  // As a proof for limits as written it would do for the task above as well, where a shorter design verifies.
  DesignResult forged = result;
  forged.task = twenty_taps(1.0 - 5e-10);
  const CheckReport report = check_certificate(forged.task, forged);
  EXPECT_FALSE(report.accepted) << report.reason;
}

// The filter has no choice, so the smallest delay of a corner error is that of the boxcar, by simulation.
TEST(GrantedLimits, SmallestDelayAtTheEdgeOfATolerance) {
  for (const double interior : {90.0, 105.0, 120.0}) {
    for (const int delay : {3, 8}) {
      std::vector<CornerResult> corners;
      verify_by_simulation(twenty_taps(1.0, interior), boxcar(19), {delay}, nullptr, &corners);
      const double error = corners[0].corner_error;
      for (const auto& [part, smallest] : {std::pair{1.0 - 5e-10, delay}, {1.0 - 1e-6, delay + 1}}) {
        const Task task = twenty_taps(1.0, interior, part * error);
        ASSERT_EQ(verify_by_simulation(task, boxcar(19), {delay}).feasible, smallest == delay);
        Task one_order = task;
        one_order.design.order_max = 19;
        const DesignResult result = design_exact(one_order);
        EXPECT_EQ(result.status, Status::optimal) << interior << " " << delay << " " << result.message;
        ASSERT_EQ(result.corners.size(), 1u);
        EXPECT_EQ(result.corners[0].delay, smallest) << interior << " " << part;
        EXPECT_TRUE(check_certificate(one_order, result).accepted);
      }
    }
  }
}

TEST(GrantedLimits, CertificatesNameTheTolerance) {
  const Task task = twenty_taps(1.0);
  DesignResult result = design_exact(task);
  ASSERT_TRUE(result.certificate);
  Certificate narrower = *result.certificate;
  auto& proof = std::get<proof::BranchAndBound>(narrower.proof);
  EXPECT_GT(proof.tolerance, verification_tolerance);
  for (const double tolerance : {0.0, 1e-9, -1.0, 1e308, std::nan("")}) {
    proof.tolerance = tolerance;
    result.certificate = std::make_shared<Certificate>(narrower);
    const CheckReport report = check_certificate(task, result);
    EXPECT_FALSE(report.accepted);
    EXPECT_NE(report.reason.find("verification grants"), std::string::npos) << report.reason;
  }
}

// A task that contradicts itself must do so by more than the verification grants.
TEST(GrantedLimits, FeedsAtTheEdgeOfALimit) {
  for (const auto& [part, contradicts] : {std::pair{1.0 - 5e-10, false}, {1.0 - 1e-8, true}}) {
    Task task = twenty_taps(1.0);
    for (Axis& axis : task.machine.axes) axis.velocity_max = part * 0.1;
    const DesignResult result = design_exact(task);
    EXPECT_EQ(result.status, contradicts ? Status::infeasible : Status::optimal);
    EXPECT_TRUE(check_certificate(task, result).accepted);
  }
}

}  // namespace
}  // namespace accdec
