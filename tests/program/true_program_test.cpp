#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "program_command.hpp"

// The statements of `accdec program` about fine periods, dwells and circles are true.

namespace {

using accdec::test::ProgramCommand;
using testing::HasSubstr;
using testing::StartsWith;

// At short periods a limit of jerk is a difference of steps that agree in six digits.
TEST_F(ProgramCommand, JerksOfShortPeriodsAreRecordedAsTheyAre) {
  for (const char* period : {"0.25", "0.1"}) {
    write("fine.toml", "sample_period_ms = " + std::string(period) +
                           "\n[filter]\nkind = \"boxcar\"\norder = 12\n[[axis]]\nvelocity_max_mm_s = 100\n"
                           "acceleration_max_mm_s2 = 3000\njerk_max_mm_s3 = 50000\n");
    for (const char* move : {"G0 X77.7", "G0 X20", "G0 X50.5", "G1 F3000 X77.7", "G1 F3000 X7.7 Y3.1"}) {
      write("part.ngc", std::string(move) + "\n");
      ASSERT_EQ(run("program part.ngc --task fine.toml --json r.json").code, 0) << read("err");
      EXPECT_THAT(run("verify r.json").out, StartsWith("accepted: ")) << period << " " << move;
    }
  }
}

// A task with modes leaves out less, and its result says the same.
TEST_F(ProgramCommand, ResultsUnderABoundOfVibrationAreAccepted) {
  for (const char* damping : {"", "damping_ratio = 0.05\n"}) {
    write("mode.toml", std::string("sample_period_ms = 1\n[[axis]]\nvelocity_max_mm_s = 300\n"
                                   "acceleration_max_mm_s2 = 3000\njerk_max_mm_s3 = 100000\n"
                                   "[[mode]]\nfrequency_Hz = [38, 46]\nresidual_max = 0.1\n") +
                           damping);
    write("part.ngc", "G64 P0.05 F3000\nG1 X50\nG1 Y30\n");
    for (const char* plan : {"fixed", "profiles"}) {
      ASSERT_EQ(run("program part.ngc --task mode.toml --json r.json --plan " + std::string(plan)).code, 0);
      EXPECT_THAT(run("verify r.json").out, StartsWith("accepted: ")) << plan << damping;
    }
  }
}

// A machine waits for its spindle before the first move, whatever the plan.
TEST_F(ProgramCommand, ADwellBeforeTheFirstMoveIsKept) {
  write("free.toml",
        "sample_period_ms = 0.5\n[[axis]]\nvelocity_max_mm_s = 100\nacceleration_max_mm_s2 = 8000\n"
        "jerk_max_mm_s3 = 400000\n");
  const std::string moves = "G1 X0.393 Y0.007\nX13.075 Y-0.965\nX0.7\n";
  for (const char* plan : {"fixed", "profiles", "free"}) {
    const auto seconds = [&](const std::string& before) {
      write("part.ngc", "G64 P0.05 F3000\n" + before + moves);
      EXPECT_EQ(run("program part.ngc --task free.toml --json r.json --plan " + std::string(plan)).code, 0);
      EXPECT_THAT(run("verify r.json").out, StartsWith("accepted: ")) << plan;
      return 0.5e-3 * number_of("r.json", "samples");
    };
    EXPECT_NEAR(seconds("G4 P0.123\n"), seconds("") + 0.123, 0.01) << plan;
  }
}

// G61 passes the point exactly; only G61.1 stops there. Two turns in two blocks are the motion of two turns in one.
TEST_F(ProgramCommand, ArcsThatGoOnAlongTheirCircleDoNotStopUnderG61) {
  write("circle.toml",
        "sample_period_ms = 1\n[[axis]]\nvelocity_max_mm_s = 500\nacceleration_max_mm_s2 = 1000\n"
        "jerk_max_mm_s3 = 50000\n");
  const auto seconds = [&](const std::string& moves, const std::string& options) {
    write("part.ngc", "G21 G90 F6000\n" + moves);
    EXPECT_EQ(run("program part.ngc --task circle.toml --json r.json --time-limit 20 " + options).code, 0);
    EXPECT_THAT(run("verify r.json").out, StartsWith("accepted: "));
    return 1e-3 * number_of("r.json", "samples");
  };
  const double one = seconds("G61\nG2 I10 P2\n", "--plan profiles");
  for (const char* options : {"--plan profiles", "--plan profiles --compensate-arcs"}) {
    EXPECT_NEAR(seconds("G61\nG2 I10\nG2 I10\n", options), one, 0.01) << options;
    EXPECT_NEAR(seconds("G61\nG2 X10 Y10 I10\nG2 X0 Y0 J-10\nG2 I10\n", options), one, 0.01) << options;
  }
  const double stops = seconds("G61.1\nG2 I10\nG2 I10\n", "--plan profiles");
  EXPECT_GT(stops, one + 0.05);
  EXPECT_GT(seconds("G61\nG2 I10\nG2 I11\n", "--plan profiles"), one) << "another circle";
}

// The plan at kept feeds by another filter takes as long as the result, which has kept feeds, too.
TEST_F(ProgramCommand, TimesOfExactStopsAreThoseOfTheFilterOfTheResult) {
  write("quick.toml",
        "sample_period_ms = 2\n[[axis]]\nvelocity_max_mm_s = 200\nacceleration_max_mm_s2 = 20000\n"
        "jerk_max_mm_s3 = 2000000\n");
  write("part.ngc",
        "G21 G90 G64 P0.3 F600\nG1 X1.4163 Y0.9121\nG1 X1.3866 Y0.8986\nG2 X1.2646 Y0.6211 R1.0840\nG64 P0.1\n"
        "G1 Z2\nG1 X1.2397 Y0.4654\nM2\n");
  ASSERT_EQ(run("program part.ngc --task quick.toml --json r.json").code, 0) << read("err");
  EXPECT_THAT(run("verify r.json").out, StartsWith("accepted: "));
}

}  // namespace
