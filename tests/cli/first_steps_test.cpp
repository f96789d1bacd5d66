#include <filesystem>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "support/paths.hpp"
#include "support/run.hpp"

// The first steps of a new user: a task to start from, the binding limits, help from the shell.

namespace accdec {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::ordered_json;

const std::filesystem::path machines = accdec::test_support::source_folder() + "/problems/machine";

std::string content(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// A shell command's standard output.
std::string shell(const std::string& command) {
  const TemporaryFolder folder;
  const std::string script = folder.write("script", command);
  if (std::system(("bash " + quoted(script) + " >" + quoted(folder.path("out")) + " 2>&1 </dev/null").c_str()) != 0)
    return "failed: " + folder.read("out");
  return folder.read("out");
}

bool installed(const std::string& program) {
  return std::system(("command -v " + program + " >/dev/null").c_str()) == 0;
}

std::vector<std::string> words(const std::string& text) {
  std::istringstream in(text);
  return {std::istream_iterator<std::string>(in), {}};
}

TEST(Init, WritesEveryShippedMachineAsItIs) {
  const std::string list = run({"init", "--list"}).out;
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(machines)) {
    const std::string name = entry.path().stem();
    SCOPED_TRACE(name);
    ++count;
    EXPECT_THAT(list, HasSubstr("\n" + name + " "));
    EXPECT_EQ(run({"init", "--machine", name}).out, content(entry.path()));
  }
  EXPECT_GE(count, 5U);
  EXPECT_EQ(run({"init"}).out, content(machines / "mill.toml"));
}

TEST(Init, WhatItWritesIsDesignedAndSavesSomething) {
  const TemporaryFolder folder;
  for (const char* name : {"mill", "router", "laser", "linear-motor", "printer"}) {
    SCOPED_TRACE(name);
    const std::string task = folder.path(std::string(name) + ".toml");
    const Outcome init = run({"init", "--machine", name, "--out", task});
    EXPECT_EQ(init.code, 0) << init.err;
    EXPECT_THAT(init.out, HasSubstr("accdec design " + task));
    const Outcome design = run({"design", task});
    EXPECT_EQ(design.code, 0) << design.err;
    EXPECT_THAT(design.out, HasSubstr("\nstatus      optimal"));
    // Today's filter holds the limits too, and is slower.
    EXPECT_THAT(design.out, ::testing::ContainsRegex("\ntoday: .* ms with delay [0-9]+; the design saves [1-9]"));
    // Beside it the best filter of every family that was found in a moment, none of them faster than what is proved.
    EXPECT_THAT(design.out, ::testing::ContainsRegex(
                                "\ntwo averages \\(trapezoidal acceleration, the industry's S-curve\\) .*[0-9]"));
    EXPECT_THAT(design.out, Not(::testing::ContainsRegex("  -[0-9]+\\.[0-9]\n")));
    EXPECT_THAT(run({"design", task, "--no-baselines"}).out, Not(HasSubstr("more %")));
    EXPECT_THAT(run({"design", task, "--json", "-"}).out, Not(HasSubstr("today:")));
    // Words of the tables' heads are explained where they stand.
    EXPECT_THAT(design.out, HasSubstr("\nN         order of the filter: its number of taps minus 1\nd   "));
    EXPECT_THAT(design.out, HasSubstr("\ncontour   largest distance of the path from the programmed legs\n"));
    // Real parameters have at most four digits.
    EXPECT_THAT(design.out, Not(::testing::ContainsRegex("(ratio|alpha|cutoff) = [0-9.]*[1-9][0-9]{4}")));
  }
}

// The pairs of averages within the router's limits were tried one by one. They take at least 154 ms (order 96, ramp 30,
// delay 57), with a ZV pair at least 148 (order 90, ramp 7, pair 17, delay 57). Today's take 183, the optimum 146.
TEST(Design, SavesByRetuningAFamilyAndFreeTaps) {
  const std::string task = accdec::test_support::source_folder() + "/problems/machine/router.toml";
  const TemporaryFolder folder;
  const std::string file = folder.path("result.json");
  const Outcome design = run({"design", task, "--json", file});
  EXPECT_THAT(design.out, HasSubstr("the design saves 37 ms (20.2 %)"));
  EXPECT_THAT(design.out, HasSubstr("\n  29 ms (15.8 %) by retuning what you have: order 96, ramp = 30\n"));
  EXPECT_THAT(design.out, ::testing::ContainsRegex("\n  (at most )?[28] ms \\([14]\\.[14] %\\) by free taps\n"));
  const Json saved = Json::parse(folder.read("result.json"))["savings"];
  EXPECT_NEAR(saved["today_s"], 0.183, 1e-12);
  EXPECT_NEAR(saved["by_retuning_s"], 0.029, 1e-12);
  // A second may not be enough for the second family, and then not everything is said to be searched.
  const double by_family = saved["by_family_s"];
  if (saved["complete"] || by_family > 0.0) {
    EXPECT_NEAR(by_family, 0.006, 1e-12);
  }
  EXPECT_NEAR(saved["by_free_taps_s"], 0.008 - by_family, 1e-12);
  EXPECT_EQ(run({"verify", file}).code, 0);
}

TEST(Init, DoesNotReplaceAFileUnasked) {
  const TemporaryFolder folder;
  const std::string task = folder.write("task.toml", "mine");
  const Outcome refused = run({"init", "--out", task});
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.err, HasSubstr("task.toml: there is a file already"));
  EXPECT_EQ(folder.read("task.toml"), "mine");
  EXPECT_EQ(run({"init", "--out", task, "--force"}).code, 0);
  EXPECT_EQ(folder.read("task.toml"), content(machines / "mill.toml"));
  EXPECT_EQ(run({"init", "--machine", "lathe"}).code, 2);
  EXPECT_EQ(run({"init", "--out", folder.path("none/task.toml")}).code, 2);
}

TEST(Explain, TextAndJsonSayTheSame) {
  const std::string task = accdec::test_support::source_folder() + "/problems/corner/acceleration-jerk.toml";
  const Outcome text = run({"explain", task});
  EXPECT_EQ(text.code, 0) << text.err;
  EXPECT_EQ(text.err, "");  // progress is for terminals
  EXPECT_THAT(text.out, HasSubstr("proved to be the shortest"));
  EXPECT_THAT(text.out, HasSubstr("With 10 % more room"));
  // Savings come first; samples are for those who ask.
  EXPECT_LT(text.out.find("With 10 % more room"), text.out.find("Used to the full"));
  EXPECT_THAT(text.out, Not(HasSubstr("k = ")));
  EXPECT_THAT(run({"explain", task, "--verbose"}).out, HasSubstr(": k = "));
  const Json json = Json::parse(run({"explain", task, "--by", "0.1", "--json", "-"}).out);
  EXPECT_EQ(json["schema"], "accdec.explanation/1");
  EXPECT_EQ(json["status"], "optimal");
  // The objective is that of the design, and what is saved is the difference.
  const Json design = Json::parse(run({"design", task, "--json", "-"}).out);
  EXPECT_EQ(json["objective_s"], design["cycle_time_s"]);
  ASSERT_FALSE(json["gains"].empty());
  for (const Json& gain : json["gains"]) {
    EXPECT_NEAR(gain["gain_s"].get<double>(), json["objective_s"].get<double>() - gain["objective_s"].get<double>(),
                1e-12);
    EXPECT_THAT(text.out, HasSubstr("\n" + gain["name"].get<std::string>() + " "));
    for (const Json& lever : gain["levers"])
      EXPECT_NEAR(lever["relaxed"].get<double>(), 1.1 * lever["value"].get<double>(), 1e-6);
  }
}

// 16 taps, 20 needed: a = v/(16 T) = 6250 mm/s^2 or v = 16 a T = 4800 mm/min.
TEST(Explain, SaysWhatMakesATaskFeasible) {
  const TemporaryFolder folder;
  const std::string task = folder.write("task.toml", R"(sample_period_ms = 1
[design]
order_max = 15
[[axis]]
acceleration_max_mm_s2 = 5000
[[corner]]
angle_deg = 180
feed_in_mm_min = 6000
feed_out_mm_min = 6000
)");
  const Outcome text = run({"explain", task});
  EXPECT_EQ(text.code, 1);
  EXPECT_THAT(text.out, ::testing::ContainsRegex("acceleration x +5000 mm/s\\^2 +62[56][0-9] mm/s\\^2 +\\+25"));
  EXPECT_THAT(text.out, ::testing::ContainsRegex("feeds of corner A +6000 mm/min +4(800|79[0-9]) mm/min +-20"));
  EXPECT_THAT(text.out, ::testing::ContainsRegex("highest order +15 +19 +\\+26.7 %"));
  const Json json = Json::parse(run({"explain", task, "--json", "-"}).out);
  EXPECT_EQ(json["status"], "infeasible");
  EXPECT_FALSE(json["remedies"].empty());
}

TEST(Explain, BadUsage) {
  const std::string task = accdec::test_support::source_folder() + "/problems/corner/exact-stop.toml";
  for (const char* by : {"0", "100%", "x", "-5%"}) EXPECT_EQ(run({"explain", task, "--by", by}).code, 2) << by;
  EXPECT_EQ(run({"explain", task, "--time-limit", "0"}).code, 2);
  EXPECT_EQ(run({"explain", "none.toml"}).code, 2);
  EXPECT_THAT(run({"explain", "--help"}).out, HasSubstr("(default 300)"));
}

// Every option that help shows is completed in every shell: nothing is written down twice.
TEST(Completion, KnowsEveryCommandAndOption) {
  for (const char* shell_name : {"bash", "zsh", "fish"}) {
    const std::string script = run({"completion", shell_name}).out;
    const bool fish = std::string(shell_name) == "fish";
    std::istringstream help(run({"--help"}).out);
    bool listed = false;
    for (std::string line; std::getline(help, line);) {
      if (listed && line.starts_with("  ") && line[2] != ' ') {
        const std::string command = line.substr(2, line.find(' ', 2) - 2);
        EXPECT_THAT(script, HasSubstr(command));
        std::istringstream options(run({command, "--help"}).out);
        for (std::string option; std::getline(options, option);) {
          if (!option.starts_with("  -")) continue;
          for (const std::string& word : words(option.substr(0, option.find("  ", 3)))) {
            const std::size_t at = word.find("--");
            if (at == std::string::npos) continue;
            EXPECT_THAT(script, HasSubstr((fish ? "-l " : "--") + word.substr(at + 2))) << command << shell_name;
          }
        }
      }
      if (line.starts_with("Subcommands:")) listed = true;
    }
  }
  EXPECT_EQ(run({"completion", "tcsh"}).code, 2);
}

TEST(Completion, WorksInBash) {
  const TemporaryFolder folder;
  folder.write("task.toml", "");
  folder.write("result.json", "");
  const auto completed = [&](const std::string& line) {
    return words(shell("cd " + quoted(folder.path("")) + "; source <(" + quoted(accdec::test_support::program()) +
                       " completion bash); COMP_WORDS=(" + line +
                       "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _accdec; echo \"${COMPREPLY[@]}\""));
  };
  using ::testing::ElementsAre;
  using ::testing::UnorderedElementsAre;
  EXPECT_THAT(completed("accdec des"), ElementsAre("design"));
  EXPECT_THAT(completed("accdec -q ver"), ElementsAre("verify"));
  EXPECT_THAT(completed("accdec design --base"), ElementsAre("--baselines"));
  EXPECT_THAT(completed("accdec design --method ''"), UnorderedElementsAre("exact", "nlp"));
  EXPECT_THAT(completed("accdec design ''"), ElementsAre("task.toml"));
  EXPECT_THAT(completed("accdec verify ''"), ElementsAre("result.json"));
  EXPECT_THAT(completed("accdec init --machine pr"), ElementsAre("printer"));
}

TEST(Completion, WorksInFish) {
  if (!installed("fish")) GTEST_SKIP() << "fish is not installed";
  const auto completed = [&](const std::string& line) {
    return shell("fish --no-config -c " +
                 quoted(accdec::test_support::program() + " completion fish | source; complete -C \"" + line + "\""));
  };
  EXPECT_THAT(completed("accdec des"), ::testing::StartsWith("design\t"));
  EXPECT_THAT(completed("accdec design --base"), ::testing::StartsWith("--baselines\t"));
  EXPECT_THAT(words(completed("accdec design --method ")), Contains("exact"));
}

TEST(Completion, ZshTakesIt) {
  if (!installed("zsh")) GTEST_SKIP() << "zsh is not installed";
  EXPECT_EQ(shell(quoted(accdec::test_support::program()) + " completion zsh | zsh -n"), "");
}

// A terminal gets colours unless NO_COLOR is set, and nothing else does.
TEST(Terminal, ColoursOnTerminalsOnly) {
  if (shell("script -qec 'echo here' /dev/null 2>&1").find("here") == std::string::npos)
    GTEST_SKIP() << "script (bsdutils) is not installed, or there are no pseudo-terminals, as in a bare chroot";
  const std::string design = accdec::test_support::program() + " design " + accdec::test_support::source_folder() +
                             "/problems/corner/exact-stop.toml";
  const auto in_terminal = [&](const std::string& environment) {
    return shell(environment + " script -qec " + quoted(design) + " /dev/null");
  };
  EXPECT_THAT(in_terminal("TERM=xterm"), HasSubstr("status      \x1b[1;32moptimal\x1b[0m"));
  EXPECT_THAT(in_terminal("TERM=xterm NO_COLOR=1"), HasSubstr("status      optimal"));
  EXPECT_THAT(in_terminal("TERM=dumb"), Not(HasSubstr("\x1b")));
  EXPECT_THAT(shell("TERM=xterm " + design), Not(HasSubstr("\x1b")));
}

}  // namespace
}  // namespace accdec
