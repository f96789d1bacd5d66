#pragma once

#include <vector>

#include <gtest/gtest.h>

#include <accdec/certificate.hpp>
#include <accdec/verify.hpp>

namespace accdec::testing {

/// Optimal or infeasible with a certificate that the checker accepts; a design also holds by simulation.
inline void expect_proved(const Task& task, const DesignResult& result) {
  const CheckReport report = check_certificate(task, result);
  EXPECT_TRUE(report.accepted) << report.reason;
  if (result.status == Status::infeasible) return;
  ASSERT_EQ(result.status, Status::optimal) << result.message;
  ASSERT_TRUE(result.filter);
  std::vector<int> delays;
  for (const CornerResult& c : result.corners) delays.push_back(c.delay);
  EXPECT_TRUE(verify_by_simulation(task, *result.filter, delays).feasible);
}

}  // namespace accdec::testing
