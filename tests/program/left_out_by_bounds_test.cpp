#include <string>

#include <gmock/gmock.h>

#include "program_command.hpp"

// The summary names the limits that bounds leave out; verify says that it did not recompute bounds.

namespace accdec::test {
namespace {

using testing::HasSubstr;

TEST_F(ProgramCommand, BoundsSayWhatTheyLeaveOut) {
  write("part.ngc", "G21 G90 F6000\nG1 X20\nG1 Y20\nM2\n");
  const std::string axis = "sample_period_ms = 1.0\n[[axis]]\nvelocity_max_mm_s = 200\nacceleration_max_mm_s2 = 1000\n";
  const auto summary = [&](const std::string& limits) {
    write("limits.toml", axis + limits);
    return run("program part.ngc --task limits.toml --plan profiles --json r.json").out;
  };
  EXPECT_THAT(summary(""), testing::Not(HasSubstr("ignored by the bounds")));
  const Output verified = run("verify r.json");
  EXPECT_EQ(verified.code, 0) << verified.err;
  EXPECT_THAT(verified.out, HasSubstr("; bounds were not recomputed\n"));
  EXPECT_THAT(summary("mass_kg = 10\nforce_max_N = 20\ncoulomb_N = 3\n"),
              HasSubstr("ignored by the bounds: force_max_N, but for the acceleration"));
  EXPECT_THAT(summary("mass_kg = 10\npower_max_W = 100\n"), HasSubstr("ignored by the bounds: power_max_W\n"));
}

}  // namespace
}  // namespace accdec::test
