#include <string>
#include <tuple>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "program_command.hpp"

// Programs of controls that have one kind of delay.

namespace accdec {
namespace {

using test::Output;
using test::ProgramCommand;
using testing::HasSubstr;

/// A control lists how it may take the ends of blocks. Without a kind that runs on it waits at each. The second and
/// third move meet without a turn, the third and fourth turn by less than 20 degrees.
TEST_F(ProgramCommand, AControlOfOneKindHasNoOther) {
  write("part.ngc", "G21 G90 G64 P0.05 F6000\nG1 X30\nG1 X30 Y30\nG1 Y60\nG1 X33 Y90\nG2 X43 Y100 I10\nM2\n");
  const std::string filter = "[filter]\nkind = \"averages\"\nlengths = [20, 20]\n",
                    axes = "[[axis]]\nacceleration_max_mm_s2 = 6000\njerk_max_mm_s3 = 500000\n";
  using Case = std::tuple<std::string, bool, std::string>;
  for (const auto& [kind, waits, word] : {Case("exact-stop", true, "G61.1\n"), Case("in-position", true, "G9 G1"),
                                          Case("dwell", false, "G4 P"), Case("continuous", false, "G64")}) {
    for (const std::string feeds : {"keep", "choose"}) {
      write("t.toml", fmt::format("sample_period_ms = 1\n[controller]\ndelays = \"{}\"\n{}{}", kind, filter, axes));
      const std::string command = "program part.ngc --task t.toml --json r.json --emit e.ngc --feeds ";
      if (run(command + feeds).code != 0 && kind == "continuous" && feeds == "keep") continue;
      EXPECT_THAT(read("out"), testing::StartsWith("Set these: averages of 20 ms and 20 ms (the 39 taps"));
      const Output verified = run("verify r.json");
      EXPECT_EQ(verified.code, 0) << kind << feeds << verified.out << verified.err;
      EXPECT_THAT(read("e.ngc"), HasSubstr(word));
      EXPECT_THAT(read("e.ngc"), HasSubstr("(set these: averages of 20 ms and 20 ms [the 39 taps"));
      const nlohmann::json record = nlohmann::json::parse(read("r.json"));
      const auto& commands = record["commands"];
      const auto& kinds = record["settings"]["delays"];
      for (std::size_t b = 0; b + 1 < kinds.size(); ++b) {
        const bool inside = commands["inside_arc"].get<std::string>()[b] == '1';
        if (!inside) {
          EXPECT_EQ(kinds[b], kind) << feeds << b;
        }
        if (!inside && kind == "exact-stop") {
          EXPECT_GE(commands["delay_samples"][b].get<int>(), 38) << b;
        }
      }
      if (waits) {
        EXPECT_EQ(record["feeds"], "programmed");
      }
    }
  }
}

/// Every turn reverses x. One average has a constant acceleration v / (n T), so that two of them overlap by a sample or
/// more after each wait of at most N = n - 1 samples. No wait holds above v_x = a n T / 2, and that of N holds there.
/// A wider width holds, too, at a sixth of that feed: the whole error of a short wait is within the tolerance.
TEST_F(ProgramCommand, AnInPositionWidthIsChosenBesideTheFeedThatItAllows) {
  const int legs = 20, length = 41;
  const double step = 30.0, acceleration = 6000.0;
  std::string part = "G21 G90 G64 P0.15 F20000\n";
  for (int i = 1; i <= legs; ++i) part += fmt::format("G1 X{} Y{}\n", i % 2 == 0 ? 0.0 : step, step * i);
  write("part.ngc", part + "M2\n");
  write("t.toml", fmt::format("sample_period_ms = 1\n[controller]\ndelays = \"in-position\"\n[filter]\n"
                              "kind = \"averages\"\nlengths = [{}]\n[[axis]]\nacceleration_max_mm_s2 = {}\n",
                              length, acceleration));
  ASSERT_EQ(run("program part.ngc --task t.toml --json r.json").code, 0) << read("err");
  const nlohmann::json record = nlohmann::json::parse(read("r.json"));
  const double period = 1e-3, along = step / (0.5 * acceleration * length * period), wait = (length - 1) * period;
  // A leg may end a sample later, and the feed is found to 0.1 %.
  const double at_longest_wait = legs * (1.001 * along + period) + (legs - 1) * wait + length * period;
  EXPECT_LE(record["cycle_time_s"].get<double>(), at_longest_wait);
  EXPECT_GE(record["cycle_time_s"].get<double>(), legs * along);
  EXPECT_EQ(run("verify r.json").code, 0);
}

}  // namespace
}  // namespace accdec
