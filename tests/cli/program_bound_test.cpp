#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/program_result.hpp"

namespace accdec {
namespace {

using ::testing::HasSubstr;
using ProgramBound = ProgramResult;

// How a bound is found is not repeated, but none is above a plan.
TEST_F(ProgramBound, ABoundAboveThePlanIsRejected) {
  for (const bool profiles : {false, true}) {
    ASSERT_EQ(plan(profiles ? std::vector<std::string>{"--plan", "profiles"} : std::vector<std::string>{}).code, 0);
    Json bad = json();
    const double time = bad["cycle_time_s"];
    for (const double bound : {1e308, time + 1e-3}) {
      bad["corner_bound_s"] = bound;
      const Outcome outcome = changed(bad);
      EXPECT_EQ(outcome.code, 1) << outcome.out;
      EXPECT_THAT(outcome.out, HasSubstr("but the plan takes")) << bound;
    }
    bad["corner_bound_s"] = 0.5 * time;
    for (Json& bound : bad["bounds"]) {
      if (bound["name"] == "monotone legs") bound["time_s"] = 0.5 * time;
    }
    const Outcome lower = changed(bad);
    EXPECT_EQ(lower.code, 0) << lower.out;
  }
}

TEST_F(ProgramBound, SaysWhetherItWasFinished) {
  ASSERT_EQ(plan().code, 0);
  const Json good = json();
  Json changes = good;
  for (Json& bound : changes["bounds"]) {
    EXPECT_EQ(bound["complete"], true) << bound;
    bound.erase("complete");
  }
  EXPECT_EQ(changed(changes).code, 0) << "as earlier versions wrote it";
  changes = good;
  Json& any = changes["bounds"][1];
  ASSERT_EQ(any["name"], "any motion");
  any["complete"] = false;
  EXPECT_THAT(changed(changes).out, HasSubstr("bounds[1].motions"));
  any["motions"] = any["motions"].get<std::string>() + "; not all of its linear programs solved";
  EXPECT_EQ(changed(changes).code, 0) << changed(changes).out;
  changes = good;
  changes["bounds"][2]["complete"] = false;
  EXPECT_THAT(changed(changes).out, HasSubstr("bounds[2].complete is recorded as false, found true"));
}

// Two simulations may find the largest use of a plateau at different samples.
TEST_F(ProgramBound, APlateauUsedMostAtAnotherSampleIsAccepted) {
  program_ = folder_.write("plateau.ngc",
                           "G21 G90 G61 F5000\nG0 X-3.525 Y18.720 Z0.00\nG1 X15.888 Y0.000\n"
                           "G1 X-4.458 Y-4.000\nG1 X1.000 Y-1.000\nM2\n");
  task_ = folder_.write("plateau.toml",
                        "sample_period_ms = 0.25\n[filter]\nkind = \"boxcar\"\norder = 391\n[[axis]]\n"
                        "acceleration_max_mm_s2 = 5000\njerk_max_mm_s3 = 5000\nvelocity_max_mm_s = 300\n");
  ASSERT_EQ(plan().code, 0);
  const Outcome outcome = verify();
  EXPECT_EQ(outcome.code, 0) << outcome.out;
}

}  // namespace
}  // namespace accdec
