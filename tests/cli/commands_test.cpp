#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "support/malformed_tasks.hpp"
#include "support/paths.hpp"
#include "support/run.hpp"

namespace accdec {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;
using Json = nlohmann::ordered_json;

const std::string problems = accdec::test_support::source_folder() + "/problems/";

/// The subcommands that `accdec --help` lists.
std::vector<std::string> subcommands() {
  std::istringstream help(run({"--help"}).out);
  std::vector<std::string> names;
  bool listed = false;
  for (std::string line; std::getline(help, line);) {
    if (listed && line.starts_with("  ") && line[2] != ' ') names.push_back(line.substr(2, line.find(' ', 2) - 2));
    if (line.starts_with("Subcommands:")) listed = true;
  }
  return names;
}

TEST(Cli, HelpAndVersionGoToStandardOutput) {
  const Outcome help = run({"--help"});
  EXPECT_EQ(help.code, 0);
  EXPECT_EQ(help.err, "");
  EXPECT_THAT(help.out, HasSubstr("Exit code"));
  const Outcome version = run({"--version"});
  EXPECT_EQ(version.code, 0);
  EXPECT_THAT(version.out,
              ::testing::MatchesRegex("accdec [0-9]+\\.[0-9]+\\.[0-9]+\ncommit .*\nCLI11 .*Clp [0-9.]+.*\n"));
  EXPECT_THAT(version.out, ::testing::ContainsRegex("cpp-httplib [0-9]+\\.[0-9]+"));
  EXPECT_THAT(version.out, ::testing::ContainsRegex("uPlot [0-9]+\\.[0-9]+\\.[0-9]+"));
}

TEST(Cli, HelpIsAWordToo) {
  EXPECT_EQ(run({"help"}).out, run({"--help"}).out);
  const Outcome design = run({"help", "design"});
  EXPECT_EQ(design.code, 0);
  EXPECT_EQ(design.out, run({"design", "--help"}).out);
  EXPECT_THAT(run({"help", "desing"}).err, HasSubstr("did you mean \"design\""));
}

TEST(Cli, EverySubcommandHasHelp) {
  const auto names = subcommands();
  for (const char* needed : {"evaluate", "design", "verify", "export"}) EXPECT_THAT(names, ::testing::Contains(needed));
  for (const std::string& name : names) {
    SCOPED_TRACE(name);
    const Outcome outcome = run({name, "--help"});
    EXPECT_EQ(outcome.code, 0);
    EXPECT_EQ(outcome.err, "");
    EXPECT_THAT(outcome.out, HasSubstr("Usage"));
    EXPECT_THAT(outcome.out, HasSubstr(name));
  }
}

// False claims that a checker once accepted. One had an order that depended on how samples were split, and one a range
// of delays that was one too short. One took a tolerance of zero as half of what the simulation counts as zero.
TEST(Cli, VerifyRejectsForgedProofs) {
  const std::string forged = accdec::test_support::source_folder() + "/tests/cli/forged/";
  for (const char* name : {"symmetric-cover.json", "delay-range.json", "zero-tolerance.json"}) {
    const Outcome outcome = run({"verify", forged + name});
    EXPECT_EQ(outcome.code, 1) << name;
    EXPECT_THAT(outcome.out, HasSubstr("the certificate does not hold")) << name;
  }
}

// A delay of a million samples makes the simulation of two axes walk two millions.
TEST(Cli, WhatWouldTakeTooLongToVerifyIsNotBegun) {
  const TemporaryFolder folder;
  const std::string path = folder.path("r.json");
  ASSERT_EQ(run({"design", problems + "corner/acceleration-jerk.toml", "--json", path, "-q"}).code, 0);
  Json result = Json::parse(folder.read("r.json"));
  result["corners"][0]["delay_samples"] = 1000000;
  folder.write("r.json", result.dump());
  const Outcome outcome = run({"verify", path, "--time-limit", "0.01"});
  EXPECT_EQ(outcome.code, 1) << outcome.out;
  EXPECT_THAT(outcome.err, HasSubstr("would take about"));
}

TEST(Cli, WhatWouldTakeTooLongToReadIsNotRead) {
  const TemporaryFolder folder;
  folder.write("r.json", std::string(5'000'000, ' '));
  const Outcome outcome = run({"verify", folder.path("r.json"), "--time-limit", "0.01"});
  EXPECT_EQ(outcome.code, 1) << outcome.out;
  EXPECT_THAT(outcome.err, HasSubstr("reading it would take about"));
}

TEST(Cli, WhatReadingAndWritingTakeOfTheTimeLimitIsSaidBeforeTheSearch) {
  const TemporaryFolder folder;
  std::string task = "sample_period_ms = 1\n[[axis]]\nacceleration_max_mm_s2 = 6000\n";
  for (int j = 0; j < 20000; ++j) task += fmt::format("[[corner]]\nangle_deg = 90\nfeed_in_mm_min = {}\n", 1000 + j);
  folder.write("t.toml", task);
  const Outcome outcome = run({"design", folder.path("t.toml"), "--json", "-", "--time-limit", "4"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("20000 corners took"));
  EXPECT_THAT(outcome.err, HasSubstr("the search gets"));
  EXPECT_EQ(Json::parse(outcome.out)["limits"].size(), 40000u);
}

TEST(Cli, ATableThatCannotBeWrittenIsExitCodeTwo) {
  const TemporaryFolder folder;
  const std::string command = quoted(accdec::test_support::program()) + " schema task > /dev/full";
  EXPECT_EQ(test_support::wait_for(test_support::start_shell(command, folder.path("out"), folder.path("err"))), 2);
}

TEST(Cli, ALargeProofIsLeftOutWithAWord) {
  const TemporaryFolder folder;
  const std::string path = folder.path("r.json"), task = problems + "corner/acceleration-jerk.toml";
  const Outcome outcome = run({"design", task, "--json", path, "--certificate-max", "0.001", "-q"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.err, HasSubstr("the proof, "));
  EXPECT_THAT(outcome.err, HasSubstr("--certificate-max 1 keeps it"));
  // A file without a proof claims none, and is accepted for what it says.
  const Json bare = Json::parse(folder.read("r.json"));
  EXPECT_FALSE(bare.contains("certificate"));
  EXPECT_EQ(bare["status"], "feasible");
  EXPECT_EQ(run({"verify", path}).code, 0);
  ASSERT_EQ(run({"design", task, "--json", path, "--certificate-max", "1", "-q"}).err, "");
  EXPECT_TRUE(Json::parse(folder.read("r.json")).contains("certificate"));
}

// 1e308 for a sample in a proof once was read as the most negative whole number and used as a place.
TEST(Cli, VerifySurvivesNumbersThatAreNoSamples) {
  const Outcome outcome =
      run({"verify", accdec::test_support::source_folder() + "/tests/cli/forged/sample-out-of-range.json"});
  EXPECT_THAT(outcome.code, ::testing::AnyOf(1, 2)) << outcome.out << outcome.err;
}

TEST(Cli, BadUsageIsExitCodeTwo) {
  for (const std::vector<std::string>& arguments :
       std::vector<std::vector<std::string>>{{},
                                             {"desing"},
                                             {"evaluate"},
                                             {"evaluate", "a", "b"},
                                             {"evaluate", "--jsno", "a"},
                                             {"verify"},
                                             {"export", "r.json"},
                                             {"export", "r.json", "--format", "xml"},
                                             {"design", "a", "--method", "guess"},
                                             {"--nothing"}}) {
    SCOPED_TRACE(::testing::PrintToString(arguments));
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, 2);
    EXPECT_EQ(outcome.out, "");
    EXPECT_NE(outcome.err, "");
  }
}

TEST(Cli, UnknownCommandsAndSolversGetASuggestion) {
  const Outcome command = run({"-q", "desing", "t.toml"});
  EXPECT_EQ(command.code, 2);
  EXPECT_THAT(command.err,
              StartsWith("unknown command \"desing\"; did you mean \"design\"? known are init, evaluate, design"));
  const Outcome solver = run({"design", problems + "corner/power.toml", "--solver", "iopt"});
  EXPECT_EQ(solver.code, 2);
  EXPECT_THAT(solver.err, HasSubstr("unknown solver \"iopt\"; did you mean \"ipopt\"? known are ipopt"));
}

TEST(Cli, UnknownOptionsAndValuesOfOptionsGetASuggestion) {
  const std::string task = problems + "corner/power.toml";
  const auto said = [](const std::vector<std::string>& arguments) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, 2) << ::testing::PrintToString(arguments);
    EXPECT_EQ(outcome.out, "");
    return outcome.err;
  };
  EXPECT_THAT(said({"design", task, "--metod", "nlp"}),
              StartsWith("unknown option \"--metod\"; did you mean \"--method\"?"));
  EXPECT_THAT(said({"design", "--time-limt=3"}), HasSubstr("did you mean \"--time-limit\"?"));
  EXPECT_THAT(said({"--qiet", "design", task}), HasSubstr("did you mean \"--quiet\"?"));
  EXPECT_THAT(said({"design", task, "--method", "exat"}),
              HasSubstr("--method: unknown value \"exat\"; did you mean \"exact\"?"));
  EXPECT_THAT(said({"program", task, "--task", task, "--plan", "profile"}), HasSubstr("did you mean \"profiles\"?"));
  EXPECT_THAT(said({"program", task, "--task", task, "--feeds", "kep"}), HasSubstr("did you mean \"keep\"?"));
  EXPECT_THAT(said({"export", "r.json", "--format", "cvs"}), HasSubstr("did you mean \"csv\"?"));
  EXPECT_THAT(said({"init", "--machine", "mil"}), HasSubstr("did you mean \"mill\"?"));
  EXPECT_THAT(said({"program", task, "--", "--task", task}),
              StartsWith("--task stands after \"--\", which ends the options\n"));
  EXPECT_THAT(said({"program", "-g.ngc", "--task", task}),
              StartsWith("unknown option \"-g.ngc\"; a file of this name is written ./-g.ngc"));
}

// Files given to the wrong command: each says what it expected and what the file seems to be.
TEST(Cli, AFileOfTheWrongKindIsNamed) {
  const TemporaryFolder folder;
  const std::string task = problems + "corner/power.toml", result = folder.path("r.json"),
                    program = problems + "program/star.ngc", study = problems + "study/pareto.toml",
                    suite = problems + "suite/quick.toml", mill = problems + "program/mill.toml";
  ASSERT_EQ(run({"design", problems + "corner/acceleration-jerk.toml", "--json", result, "-q"}).code, 0);
  const std::vector<std::pair<std::vector<std::string>, std::string>> calls{
      {{"explain", result}, "a task is expected, this seems to be a result, which `accdec verify`"},
      {{"design", study}, "a task is expected, this seems to be a study, which `accdec study` takes"},
      {{"evaluate", suite}, "a task is expected, this seems to be a suite, which `accdec compare` takes"},
      {{"design", program}, "a task is expected, this seems to be a program"},
      {{"verify", task}, "a result is expected, this seems to be a task, which `accdec design`"},
      {{"plot", task, "--out", folder.path("x.svg")}, "a result is expected, this seems to be a task"},
      {{"export", study, "--format", "csv", "--out", folder.path("x.csv")}, "a result is expected, this seems to be a"},
      {{"study", task, "--out", folder.path("s")}, "a study is expected, this seems to be a task"},
      {{"compare", study, "--out", folder.path("c")}, "a suite is expected, this seems to be a study"},
      {{"program", task, "--task", mill}, "a program is expected, this seems to be a task"},
      {{"program", result, "--task", mill}, "a program is expected, this seems to be a result"},
      {{"plot", result, "--out", folder.path("x.sgv")}, "did you mean .svg?"}};
  for (const auto& [words, text] : calls) {
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.code, 2) << ::testing::PrintToString(words);
    EXPECT_THAT(outcome.err, HasSubstr(text));
  }
  for (const auto& [right, wrong] :
       {std::pair("[[axis]]", "[[axes]]"), std::pair("[[axis]]", "[axes]"), std::pair("[[corner]]", "[[corners]]")}) {
    std::string text = "sample_period_ms = 1\n[[axis]]\n[[corner]]\nangle_deg = 90\nfeed_in_mm_min = 100\n";
    text.replace(text.find(right), std::string_view(right).size(), wrong);
    folder.write("t.toml", text);
    EXPECT_THAT(run({"design", folder.path("t.toml")}).err, HasSubstr("did you mean `")) << wrong;
  }
}

// "nan" is in every range, if one asks whether it is below or above.
TEST(Cli, NumbersOfOptionsAreFiniteAndInRange) {
  const std::string task = problems + "corner/power.toml", g = problems + "program/star.ngc";
  const std::string mill = problems + "program/mill.toml";
  for (const std::vector<std::string>& command :
       std::vector<std::vector<std::string>>{{"verify", task, "--time-limit"},
                                             {"design", task, "--time-limit"},
                                             {"design", task, "--gap"},
                                             {"design", task, "--seed"},
                                             {"design", task, "--certificate-max"},
                                             {"explain", task, "--time-limit"},
                                             {"explain", task, "--by"},
                                             {"optima", task, "--out", "/nowhere", "--time-limit"},
                                             {"optima", task, "--out", "/nowhere", "--halvings"},
                                             {"evaluate", task, "--circle-feed-mm-min", "100", "--circle-radius-mm"},
                                             {"evaluate", task, "--circle-radius-mm", "100", "--circle-feed-mm-min"},
                                             {"program", g, "--task", mill, "--time-limit"},
                                             {"program", g, "--task", mill, "--arc-tolerance-um"},
                                             {"program", g, "--task", mill, "--worst"},
                                             {"generate", "star", "--feed"},
                                             {"generate", "star", "--tolerance"},
                                             {"generate", "star", "--blocks"},
                                             {"study", task, "--workers"},
                                             {"study", task, "--slurm"},
                                             {"compare", task, "--workers"}}) {
    for (const char* number : {"nan", "-1", "inf", "1e999", "x", ""}) {
      std::vector<std::string> arguments = command;
      arguments.back() += std::string("=") + number;
      SCOPED_TRACE(::testing::PrintToString(arguments));
      const Outcome outcome = run(arguments);
      EXPECT_EQ(outcome.code, 2);
      EXPECT_THAT(outcome.err, HasSubstr(command.back()));
    }
  }
}

/// The tables of keys in problems/README.md are those of the program; if not: problems/update-keys.
TEST(Cli, TheDocumentedKeysAreThoseOfTheReaders) {
  std::ifstream file(problems + "README.md");
  const std::string page{std::istreambuf_iterator<char>(file), {}};
  for (const std::string kind : {"task", "study", "suite", "result", "controller"}) {
    const Outcome table = run({"schema", kind, "--markdown"});
    EXPECT_EQ(table.code, 0);
    const std::string command = "accdec schema " + kind + " --markdown";
    EXPECT_THAT(page, HasSubstr("<!-- " + command + " -->\n" + table.out + "<!-- end of " + kind + " -->"))
        << "stale: run problems/update-keys";
  }
  EXPECT_EQ(run({"schema", "tusk"}).code, 2);
}

TEST(Cli, InputThatCannotBeRead) {
  const TemporaryFolder folder;
  const std::string zero = folder.write("zero", std::string("a\0b", 3));
  for (const char* command : {"evaluate", "design", "verify"}) {
    SCOPED_TRACE(command);
    const Outcome missing = run({command, folder.path("none")});
    EXPECT_EQ(missing.code, 2);
    EXPECT_THAT(missing.err, HasSubstr("none: no such file"));
    const Outcome directory = run({command, folder.path("")});
    EXPECT_EQ(directory.code, 2);
    EXPECT_THAT(directory.err, HasSubstr("is a directory"));
    const Outcome binary = run({command, zero});
    EXPECT_EQ(binary.code, 2);
    EXPECT_THAT(binary.err, HasSubstr("not a text file"));
  }
  EXPECT_EQ(folder.count(), 1U);
}

TEST(Cli, TablesGoToStandardOutputUnlessQuietOrJsonDoes) {
  const std::string task = problems + "paper/table2.toml";
  const Outcome table = run({"evaluate", task});
  EXPECT_EQ(table.err, "");
  EXPECT_THAT(table.out, HasSubstr("2441.87"));
  for (const auto& arguments : {std::vector<std::string>{"--quiet", "evaluate", task}, {"evaluate", task, "--quiet"}}) {
    const Outcome quiet = run(arguments);
    EXPECT_EQ(quiet.code, 0);
    EXPECT_EQ(quiet.out + quiet.err, "");
  }
  const Outcome design = run({"design", problems + "machine/given-filter.toml", "--json", "-"});
  EXPECT_EQ(design.code, 0);
  EXPECT_TRUE(Json::accept(design.out));
}

TEST(Cli, ABrokenLimitIsExitCodeOneWithTheResultWritten) {
  const TemporaryFolder folder;
  std::string text = malformed::Parts{}.str();
  text.replace(text.find("error_max_um = 400"), 18, "error_max_um = 1");
  const std::string task = folder.write("task.toml", text);
  const Outcome outcome = run({"evaluate", task, "--json", folder.path("result.json")});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.out, HasSubstr("BROKEN"));
  const Json json = Json::parse(folder.read("result.json"));
  EXPECT_EQ(json["status"], "failed");
  EXPECT_THAT(json["message"].get<std::string>(), HasSubstr("corner error"));
  EXPECT_EQ(json["filter"]["order"], 20);
  const Outcome verdict = run({"verify", folder.path("result.json")});
  EXPECT_EQ(verdict.code, 1);
  EXPECT_THAT(verdict.out, StartsWith("rejected"));
  const Outcome quiet = run({"evaluate", task, "-q"});
  EXPECT_EQ(quiet.code, 1);
  EXPECT_EQ(quiet.out, "");
  EXPECT_THAT(quiet.err, HasSubstr("corner error"));
}

TEST(Cli, DesignVerifyExport) {
  const TemporaryFolder folder;
  const std::string result = folder.path("result.json");
  ASSERT_EQ(run({"design", problems + "machine/given-filter.toml", "--json", result}).code, 0);
  const Outcome verdict = run({"verify", result});
  EXPECT_EQ(verdict.code, 0);
  EXPECT_THAT(verdict.out, StartsWith("accepted"));

  // A smaller delay in the file breaks the tolerance; a better-looking number is not what the simulation finds.
  Json json = Json::parse(folder.read("result.json"));
  json["corners"][0]["delay_samples"] = json["corners"][0]["delay_samples"].get<int>() - 1;
  const Outcome shortened = run({"verify", folder.write("short.json", json.dump())});
  EXPECT_EQ(shortened.code, 1);
  EXPECT_THAT(shortened.out, HasSubstr("corner A"));
  json = Json::parse(folder.read("result.json"));
  json["cycle_time_s"] = 0.9 * json["cycle_time_s"].get<double>();
  const Outcome boasting = run({"verify", folder.write("boast.json", json.dump())});
  EXPECT_EQ(boasting.code, 1);
  EXPECT_THAT(boasting.out, HasSubstr("cycle_time_s"));

  for (const std::string format : {"csv", "c", "json", "npy", "m", "st", "linuxcnc-comp"}) {
    SCOPED_TRACE(format);
    const Outcome out = run({"export", result, "--format", format});
    EXPECT_EQ(out.code, 0);
    EXPECT_EQ(out.err, "");
    EXPECT_EQ(run({"export", result, "--format", format, "--out", folder.path("taps")}).code, 0);
    EXPECT_EQ(folder.read("taps"), out.out);
  }
  const Outcome cascade = run({"export", result, "--format", "cascade", "--out", folder.path("cascade")});
  EXPECT_NE(cascade.code, 0);
  EXPECT_THAT(cascade.err, HasSubstr("misses a tap by"));
  EXPECT_FALSE(std::filesystem::exists(folder.path("cascade")));
}

TEST(Cli, OutputThatCannotBeWrittenIsRefusedBeforeTheWork) {
  const TemporaryFolder folder;
  const std::string target = folder.path("none/result.json");
  for (const char* command : {"evaluate", "design"}) {
    const Outcome outcome = run({command, problems + "paper/table2.toml", "--json", target});
    EXPECT_EQ(outcome.code, 2);
    EXPECT_EQ(outcome.out, "");
    EXPECT_THAT(outcome.err, HasSubstr(target));
  }
  EXPECT_EQ(folder.count(), 0U);
}

TEST(Cli, DamagedResultsAreRefusedWithTheirPosition) {
  const TemporaryFolder folder;
  for (const char* command : {"verify", "export"}) {
    std::vector<std::string> arguments{command, folder.write("r.json", "{\n  \"schema\": \"accdec.result/2\"\n}\n")};
    if (arguments[0] == "export") arguments.insert(arguments.end(), {"--format", "csv"});
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, 2);
    EXPECT_EQ(outcome.out, "");
    EXPECT_THAT(outcome.err, HasSubstr("r.json:2:13: schema: \"accdec.result/2\" is another kind of file"));
  }
}

}  // namespace
}  // namespace accdec
