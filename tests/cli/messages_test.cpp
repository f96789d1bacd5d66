#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "support/malformed_tasks.hpp"
#include "support/run.hpp"

// Warnings, hints and errors as a terminal, a shell and a script get them.

namespace accdec {
namespace {

using ::testing::HasSubstr;

TEST(Cli, PeriodsOfNoControllerAreWarnedOf) {
  const TemporaryFolder folder;
  const auto said = [&](const std::string& period) {
    const std::string task = folder.write("t.toml", malformed::with_top("sample_period_ms = " + period + "\n"));
    return run({"evaluate", task}).err;
  };
  EXPECT_EQ(said("0.05"), "");
  EXPECT_EQ(said("20"), "");
  EXPECT_THAT(said("1000"), HasSubstr("t.toml: sample_period_ms = 1000 is outside 0.05 to 20"));
  EXPECT_THAT(said("0.049"), HasSubstr("accdec: warning: "));
}

TEST(Cli, NamesReachNoTerminalRaw) {
  const TemporaryFolder folder;
  const std::string task = folder.write("a\x1b[31m.toml", "\"k\x1b[31m\" = 1\n");
  for (const std::string& argument : {task, folder.path("none\x1b[31m"), std::string("--\x1b[31m")}) {
    const Outcome outcome = run({"design", argument});
    EXPECT_EQ(outcome.code, 2);
    EXPECT_THAT(outcome.err, HasSubstr("\\x1b[31m"));
    EXPECT_EQ((outcome.out + outcome.err).find('\x1b'), std::string::npos) << argument;
  }
}

TEST(Cli, ProgramsWithControlCharactersInTheirNamesReachNoTerminalRaw) {
  const TemporaryFolder folder;
  const std::string program = folder.write("p\x1b[31m.ngc", "G64 P0.05 F3000\nG1 X20\nG1 Y20\nG1 X0 Y0\nM2\n");
  const std::string task =
      folder.write("t\x1b[31m.toml",
                   "sample_period_ms = 1.0\n[filter]\nkind = \"trapezoid\"\norder = 40\nramp = 10\n"
                   "[[axis]]\nacceleration_max_mm_s2 = 6000\njerk_max_mm_s3 = 500000\n");
  const std::string result = folder.path("r.json");
  for (const std::string plan : {"fixed", "profiles"}) {
    const Outcome planned = run({"program", program, "--task", task, "--plan", plan, "--json", result});
    EXPECT_EQ(planned.code, 0) << planned.err;
    EXPECT_THAT(planned.out, HasSubstr("p\\x1b[31m.ngc: 3 blocks"));
    const Outcome verified = run({"verify", result});
    EXPECT_EQ(verified.code, 0) << verified.out;
    EXPECT_THAT(verified.out, HasSubstr("p\\x1b[31m.ngc"));
    EXPECT_EQ((planned.out + planned.err + verified.out + verified.err).find('\x1b'), std::string::npos) << plan;
  }
  // Also where the program is gone: plot draws what the commands show, and says why.
  ASSERT_EQ(run({"program", program, "--task", task, "--json", result}).code, 0);
  std::filesystem::remove(program);
  for (const Outcome& outcome : {run({"plot", result, "--out", folder.path("p.svg")}), run({"verify", result})}) {
    EXPECT_THAT(outcome.err, HasSubstr("p\\x1b[31m.ngc is not there"));
    EXPECT_EQ((outcome.out + outcome.err).find('\x1b'), std::string::npos) << outcome.err;
  }
}

// U+202E turns the direction of what follows; U+0085 is a C1 control.
TEST(Cli, KeysWithUnseenCharactersReachNoTerminalRaw) {
  const TemporaryFolder folder;
  const Outcome outcome = run({"design", folder.write("t.toml", "\"k\xE2\x80\xAE\xC2\x85x\" = 1\n")});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("k\\xe2\\x80\\xae\\xc2\\x85x"));
  EXPECT_EQ(outcome.err.find("\xE2\x80\xAE"), std::string::npos);
}

TEST(Cli, SettingsOfAControllerAreTheFirstAnswer) {
  const TemporaryFolder folder;
  const std::string task =
      folder.write("t.toml",
                   "sample_period_ms = 1.0\n[design]\nfamily = \"averages\"\n[controller]\ndelays = \"in-position\"\n"
                   "[[axis]]\nacceleration_max_mm_s2 = 6000\njerk_max_mm_s3 = 500000\n"
                   "[[corner]]\nangle_deg = 95\nfeed_in_mm_min = 6000\nerror_max_um = 50\n");
  const std::string result = folder.path("r.json");
  const Outcome designed = run({"design", task, "--json", result});
  EXPECT_EQ(designed.code, 0) << designed.err;
  EXPECT_THAT(designed.out, ::testing::StartsWith("Set these: averages of 17 ms and 13 ms; in-position width 0.2294 mm "
                                                  "(0.2059 to 0.2529). 44 ms a corner, proved best for this family."));
  EXPECT_EQ(run({"verify", result}).code, 0);
  EXPECT_EQ(run({"design", task, "--solver", "ipopt"}).code, 2);
  std::string text = folder.read("t.toml");
  const std::string family = "family = \"averages\"\n[controller]\n";
  text.replace(text.find(family), family.size(), "[controller]\nname = \"fanuc-0i\"\n");
  const Outcome named = run({"design", folder.write("named.toml", text)});
  EXPECT_EQ(named.code, 0) << named.err;
  EXPECT_THAT(named.out, HasSubstr("proved best for this control."));
  const std::string program = folder.write("p.ngc", "G64 P0.05 F3000\nG1 X20\nG1 Y20\nM2\n");
  const Outcome planned = run({"program", program, "--task", task});
  EXPECT_EQ(planned.code, 0) << planned.err;
  EXPECT_THAT(planned.out, ::testing::StartsWith("Set these: averages of "));
}

TEST(Cli, HintsAreQuotedForTheShell) {
  const TemporaryFolder folder;
  const std::string name = folder.path("my task's.toml");
  const Outcome outcome = run({"init", "--out", name});
  ASSERT_EQ(outcome.code, 0);
  const std::string after = "then: accdec design ";
  const std::size_t at = outcome.out.find(after);
  ASSERT_NE(at, std::string::npos);
  EXPECT_EQ(outcome.out.substr(at + after.size()), quoted(name) + "\n");
}

TEST(Cli, AMissingToolIsExitCodeTwo) {
  const TemporaryFolder folder;
  const std::string result = folder.path("r.json"), figure = folder.path("f.svg");
  ASSERT_EQ(run({"evaluate", folder.write("t.toml", malformed::Parts{}.str()), "--json", result, "-q"}).code, 0);
  const std::string command = "PATH=/nowhere exec " + quoted(accdec::test_support::program()) + " plot " +
                              quoted(result) + " --out " + quoted(figure);
  EXPECT_EQ(test_support::wait_for(test_support::start_shell(command, folder.path("out"), folder.path("err"))), 2);
  EXPECT_THAT(folder.read("err"), HasSubstr("gnuplot is not installed (Debian package gnuplot-nox)"));
  EXPECT_FALSE(std::filesystem::exists(figure));
}

// Before any design, and without a folder that would have to be removed again.
TEST(Cli, OptimaWithoutGnuplotLeavesNothingBehind) {
  const TemporaryFolder folder;
  const std::string task = folder.write("t.toml", malformed::Parts{}.str()), results = folder.path("new/results");
  const std::string command = "PATH=/nowhere exec " + quoted(accdec::test_support::program()) + " optima " +
                              quoted(task) + " --out " + quoted(results);
  EXPECT_EQ(test_support::wait_for(test_support::start_shell(command, folder.path("out"), folder.path("err"))), 2);
  EXPECT_THAT(folder.read("err"), HasSubstr("gnuplot is not installed (Debian package gnuplot-nox)"));
  EXPECT_FALSE(std::filesystem::exists(folder.path("new")));
}

TEST(Cli, HelpStatesTheTimeLimitOfADesign) {
  EXPECT_THAT(run({"design", "--help"}).out, HasSubstr("(default 600; 9 if order_max is above 400)"));
}

// Orders beyond 400 end early by themselves, with a verified design and the part that is not proved.
TEST(Cli, LongFiltersEndEarlyAndSaySo) {
  const TemporaryFolder folder;
  folder.write("fine.toml",
               "sample_period_ms = 0.025\n[design]\norder_max = 2000\n[[axis]]\nacceleration_max_mm_s2 = 6000\n"
               "jerk_max_mm_s3 = 500000\n[[corner]]\nangle_deg = 95\nfeed_in_mm_min = 6000\nerror_max_um = 50\n");
  const std::string path = folder.path("r.json");
  ASSERT_EQ(run({"design", folder.path("fine.toml"), "--json", path, "-q", "--no-certificate"}).code, 0);
  const auto result = nlohmann::json::parse(folder.read("r.json"));
  EXPECT_EQ(result["status"], "feasible");
  EXPECT_EQ(result["stop"], "time limit");
  EXPECT_EQ(result["message"],
            "stopped before the proof was complete (9 s, the limit of orders above 400; --time-limit gives more)");
  EXPECT_GT(result["filter"]["taps"].size(), 401U);
  EXPECT_EQ(run({"verify", path}).code, 0);
}

}  // namespace
}  // namespace accdec
