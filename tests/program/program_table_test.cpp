#include <cmath>
#include <numbers>
#include <regex>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "program_command.hpp"

// The rows of times that `accdec program` prints beside its plan's.

namespace accdec::test {
namespace {

using ::testing::HasSubstr;

class ProgramTable : public ProgramCommand {
 protected:
  /// The time of a row, s; -1 without it.
  static double row(const std::string& text, const std::string& name) {
    std::smatch found;
    if (!std::regex_search(text, found, std::regex("\n  " + name + " +([0-9.]+) s"))) return -1.0;
    return std::stod(found[1]);
  }
};

constexpr double printed = 0.5e-4;  // s, the last digit

// Two lines of 20 and 10 mm at 50 mm/s behind 41 taps, and a stop between: 400 + 40 + 200 + 41 samples. Without a delay
// 400 + 200 + 41.
TEST_F(ProgramTable, RowsOfExactStopsAndOfNoDelayFollowFromTheFilter) {
  write("part.ngc", "G21 G90 G64 P0.02 F3000\nG1 X20\nG1 Y10\nM2\n");
  const auto done = run("program part.ngc --task task.toml --feeds keep");
  ASSERT_EQ(done.code, 0) << done.err;
  EXPECT_NEAR(row(done.out, "exact stop at every corner"), 0.681, printed);
  EXPECT_NEAR(row(done.out, "no delay at any corner"), 0.641, printed);
}

// A half circle of 10 mm within 5 um, behind an average of 41 taps, whose variance is (41^2 - 1)/12
// samples^2. Stops at its ends alone leave v^2 s^2/(2 R) inside the arc. The lines take 0.1 s each at their feed, every
// stop 41 samples, and the rest is the arc's.
TEST_F(ProgramTable, TheRowOfExactStopsNamesAToleranceThatArcsBreak) {
  write("arc.toml",
        "sample_period_ms = 1\n[filter]\nkind = \"boxcar\"\norder = 40\n[[axis]]\nacceleration_max_mm_s2 = 3000\n");
  write("part.ngc", "G21 G90 G17 G64 P0.005 F6000\nG1 X10\nG2 X30 I10\nG1 Y-10\nM2\n");
  const auto done = run("program part.ngc --task arc.toml --feeds keep");
  ASSERT_EQ(done.code, 0) << done.err;
  constexpr double radius = 10e-3, variance = (41.0 * 41.0 - 1.0) / 12.0 * 1e-6;
  const double arc = row(done.out, "exact stop at every corner") - 2.0 * 0.1 - 3.0 * 0.041;
  const double feed = std::numbers::pi * radius / arc;
  ASSERT_GT(feed * feed * variance / (2.0 * radius), 5e-6);
  EXPECT_THAT(done.out,
              testing::ContainsRegex("exact stop at every corner .*\n    but breaks the tolerance in line 3"));
}

// The row of programmed feeds is what `--feeds keep` takes, with a filter that is found and with a given one. The given
// one starts no move at 20 m/min, so that chosen feeds are faster.
TEST_F(ProgramTable, TheRowOfProgrammedFeedsIsThatOfKeptFeeds) {
  write("free.toml",
        "sample_period_ms = 1.0\n[[axis]]\nvelocity_max_mm_s = 500\nacceleration_max_mm_s2 = 2000\n"
        "jerk_max_mm_s3 = 100000\n[program]\nerror_max_um = 20\n");
  const std::string moves = "G1 X20\nG1 Y10\nG1 X35 Y22\nG1 X20 Y30\nG3 X20 Y10 J-10\nM2\n";
  write("free.ngc", "G21 G90 G64 P0.02 F4000\n" + moves);
  write("task.ngc", "G21 G90 G64 P0.02 F20000\n" + moves);
  for (const std::string name : {"task", "free"}) {
    const std::string command = "program " + name + ".ngc --task " + name + ".toml";
    const auto kept = run(command + " --feeds keep");
    ASSERT_EQ(kept.code, 0) << kept.err;
    const auto chosen = run(command);
    ASSERT_EQ(chosen.code, 0) << chosen.err;
    EXPECT_NEAR(row(chosen.out, "feeds as programmed"), row(kept.out, "cycle time"), printed) << name;
    EXPECT_LE(row(chosen.out, "cycle time"), row(kept.out, "cycle time") + printed) << name;
    EXPECT_EQ(row(kept.out, "feeds as programmed"), -1.0) << name;
    // Below it stand the times of other rules at these feeds.
    EXPECT_NEAR(row(chosen.out, "  with a stop at all corners"), row(kept.out, "exact stop at every corner"), printed);
    EXPECT_NEAR(row(chosen.out, "  without delays at corners"), row(kept.out, "no delay at any corner"), printed);
    EXPECT_EQ(row(chosen.out, "exact stop at every corner"), -1.0) << name;
  }
}

// If samples never move steadily, plan profiles checks each. One filter is planned in the time that is left.
TEST_F(ProgramTable, PlanProfilesThatWasNotCheckedInTimeIsNamed) {
  write("slow.toml",
        "sample_period_ms = 0.1\n[[axis]]\nvelocity_max_mm_s = 500\n"
        "acceleration_max_mm_s2 = 0.001\njerk_max_mm_s3 = 20000\n[filter]\nkind = \"boxcar\"\norder = 9999\n");
  write("part.ngc", "G21 G90 G64 P0.05\nG1 X100000 F10000\nM2\n");  // 2e8 samples that are never steady
  for (const char* plan : {"profiles", "free"}) {
    const auto done =
        run(fmt::format("program part.ngc --task slow.toml --time-limit 1 --json r.json --plan {}", plan));
    EXPECT_EQ(done.code, 0) << done.err;
    EXPECT_THAT(done.out, HasSubstr("plan fixed, filter of"));
    EXPECT_THAT(done.out, HasSubstr("plan profiles, not checked within the time limit"));
    EXPECT_THAT(done.out, HasSubstr("verified: every sample simulated, all bounds hold"));
    // From rest to rest along 100 m at 0.001 mm/s^2: at least 2 sqrt(L/a). The boxcar of 1 s rises evenly.
    EXPECT_GE(number_of("r.json", "cycle_time_s"), 2.0 * std::sqrt(100.0 / 1e-6));
  }
}

}  // namespace
}  // namespace accdec::test
