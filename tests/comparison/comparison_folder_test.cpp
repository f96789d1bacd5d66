#include <algorithm>
#include <csignal>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <thread>

#include <sys/wait.h>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <accdec/comparison/suite_file.hpp>
#include <accdec/solver.hpp>

#include "compare_command.hpp"

// The comparison as a user runs it: killed, resumed and drawn again.

namespace {

using accdec::testing::CompareCommand;
namespace fs = std::filesystem;
using accdec::testing::content;
using accdec::testing::Outcome;
using accdec::testing::write;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* tables[] = {"problems.csv", "summary.csv", "confusion.csv", "runs.csv", "pairs.csv"};

TEST_F(CompareCommand, TablesFiguresAndReportFromOneCommand) {
  const Outcome r = run("compare suite.toml --out out");
  ASSERT_EQ(r.exit_code, 0) << r.output;
  EXPECT_THAT(r.output, HasSubstr("4 problems"));
  for (const char* name : tables) EXPECT_FALSE(content(home_ / "out" / name).empty()) << name;
  for (const char* name : {"performance", "performance-end", "pairs", "data", "runtime"}) {
    EXPECT_THAT(content(home_ / "out" / fmt::format("{}.svg", name)), HasSubstr("<svg"));
    EXPECT_THAT(content(home_ / "out" / fmt::format("{}.png", name)), HasSubstr("PNG"));
  }
  EXPECT_FALSE(fs::exists(home_ / "out/comparison.journal"));
  const std::string problems = content(home_ / "out/problems.csv"), confusion = content(home_ / "out/confusion.csv"),
                    raw = content(home_ / "out/raw.jsonl");
  EXPECT_THAT(problems, HasSubstr("small,other,margin,1,30,31"));
  EXPECT_THAT(problems, HasSubstr("infeasible proved"));
  EXPECT_THAT(confusion, HasSubstr("ipopt,solved,4,0,0,0,0,0")) << "two problems from two starts, all reached";
  EXPECT_THAT(confusion, HasSubstr("clp,refused,0,0,0,0,4,4"));
  EXPECT_THAT(raw, HasSubstr(R"("record":"session")"));
  EXPECT_THAT(content(home_ / "out/manifest.json"), HasSubstr("accdec compare suite.toml --out out"));
  EXPECT_THAT(content(home_ / "out/manifest.json"), HasSubstr("3.11.9"));
  const std::string html = content(home_ / "out/report.html");
  EXPECT_THAT(html, HasSubstr("No verified answer lies below a proved bound"));
  EXPECT_THAT(html, Not(HasSubstr("href=\"http")));
  EXPECT_THAT(html, Not(HasSubstr("src=")));
}

TEST_F(CompareCommand, ShardsHaveWholeProblemsAndMergeToTheSameRuns) {
  suite(R"(["ipopt", "nlopt-slsqp"])", "", 2);
  const auto runs = [&](const char* folder) {
    std::map<std::size_t, std::string> verdicts;
    std::istringstream raw(content(home_ / folder / "raw.jsonl"));
    for (std::string line; std::getline(raw, line);) {
      const nlohmann::json row = nlohmann::json::parse(line);
      if (row.contains("index"))
        verdicts[row.at("index")] = row.value("claim", "") + row.value("verdict", "") + row.value("proof", "");
    }
    return verdicts;
  };
  ASSERT_EQ(run("compare suite.toml --out whole").exit_code, 0);
  const Outcome first = run("compare suite.toml --out parts --shard 1/2");
  ASSERT_EQ(first.exit_code, 0) << first.output;
  EXPECT_THAT(first.output, HasSubstr("Shard 1/2 is done"));
  EXPECT_FALSE(fs::exists(home_ / "parts/raw.jsonl"));
  const Outcome early = run("compare suite.toml --out parts --merge parts");
  EXPECT_EQ(early.exit_code, 2);
  EXPECT_THAT(early.output, HasSubstr("Missing: shard 2 of 2"));
  EXPECT_FALSE(fs::exists(home_ / "parts/report.html"));
  ASSERT_EQ(run("compare suite.toml --out parts --shard 2/2").exit_code, 0);
  // All runs of a problem are in one journal.
  std::set<std::size_t> cases[2];
  for (const int shard : {1, 2}) {
    std::istringstream journal(content(home_ / fmt::format("parts/shard-{}-of-2.journal", shard)));
    std::string line;
    std::getline(journal, line);
    while (std::getline(journal, line))
      cases[shard - 1].insert(nlohmann::json::parse(line.substr(line.find('{'))).at("case").get<std::size_t>());
  }
  EXPECT_EQ(cases[0].size(), 2u);
  EXPECT_EQ(cases[1].size(), 2u);
  for (const std::size_t c : cases[0]) EXPECT_FALSE(cases[1].contains(c));
  const Outcome merged = run("compare suite.toml --out parts --merge parts");
  ASSERT_EQ(merged.exit_code, 0) << merged.output;
  EXPECT_THAT(merged.output, HasSubstr("0 entries computed"));
  EXPECT_EQ(runs("parts"), runs("whole"));
}

TEST_F(CompareCommand, WithoutSlurmTheScriptsDoByThemselves) {
  suite(R"(["ipopt"])", "", 1);
  EXPECT_THAT(run("compare suite.toml --out out --slurm 9").output, HasSubstr("only 4 problems"));
  const Outcome r = run("compare suite.toml --out out --slurm 2 --solvers nlopt-slsqp,ipopt", "PATH=/nowhere");
  EXPECT_EQ(r.exit_code, 2) << r.output;
  EXPECT_THAT(r.output, HasSubstr("sbatch is not installed"));
  fs::remove(home_ / "suite.toml");  // frozen, and so are its tasks
  for (const int shard : {1, 2})
    ASSERT_EQ(std::system(fmt::format("bash '{}/out/slurm/array.sh' {} >/dev/null", home_.string(), shard).c_str()), 0);
  EXPECT_THAT(run("compare --status out", "PATH=/nowhere").output, HasSubstr("of 2 shards 2 are done"));
  ASSERT_EQ(std::system(fmt::format("bash '{}/out/slurm/merge.sh' >/dev/null", home_.string()).c_str()), 0);
  EXPECT_THAT(content(home_ / "out/summary.csv"), HasSubstr("nlopt-slsqp"));
  const Outcome status = run("compare --status out", "PATH=/nowhere");
  EXPECT_EQ(status.exit_code, 0);
  EXPECT_THAT(status.output, HasSubstr("Put together"));
  EXPECT_THAT(run("study --status out").output, HasSubstr("is of `accdec compare`"));
}

TEST_F(CompareCommand, RedrawGivesTheSameBytesWithoutSolving) {
  suite(R"(["ipopt", "nlopt-slsqp"])");
  ASSERT_EQ(run("compare suite.toml --out out").exit_code, 0);
  std::map<std::string, std::string> before;
  for (const auto& item : fs::directory_iterator(home_ / "out")) before[item.path().filename()] = content(item.path());
  for (const auto& [name, text] : before) {
    if (name != "raw.jsonl" && name != "manifest.json" && name != "accdec-folder.json")
      fs::remove(home_ / "out" / name);
  }
  fs::remove(home_ / "suite.toml");
  fs::remove(home_ / "task.toml");
  const Outcome r = run("compare --redraw out");
  ASSERT_EQ(r.exit_code, 0) << r.output;
  for (const auto& [name, text] : before) EXPECT_EQ(content(home_ / "out" / name), text) << name;
}

TEST_F(CompareCommand, KilledAtAnyMomentItGoesOnWhereItWas) {
  const auto lines = [&] {
    const std::string journal = content(home_ / "out/comparison.journal");
    return std::count(journal.begin(), journal.end(), '\n');
  };
  int kills = 0;
  for (int attempt = 0; attempt < 3; ++attempt) {
    const pid_t child = start("compare suite.toml --out out --workers 1");
    const auto before = lines();
    int status = 0;
    while (lines() < before + 8 && ::waitpid(child, &status, WNOHANG) == 0)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    if (status == 0) {
      ::kill(child, SIGKILL);
      ::waitpid(child, &status, 0);
    }
    if (WIFSIGNALED(status)) ++kills;
  }
  ASSERT_GE(kills, 1);
  EXPECT_FALSE(fs::exists(home_ / "out/report.html"));
  const Outcome unfinished = run("compare --redraw out");
  EXPECT_EQ(unfinished.exit_code, 2);
  EXPECT_THAT(unfinished.output, HasSubstr("not finished"));
  const auto done = lines() - 1;
  const Outcome last = run("compare suite.toml --out out");
  ASSERT_EQ(last.exit_code, 0) << last.output;
  EXPECT_THAT(last.output, HasSubstr(fmt::format("{} from an earlier run", done)))
      << "what was done before the kill is not done again";
  const std::string raw = content(home_ / "out/raw.jsonl");
  EXPECT_THAT(run("compare suite.toml --out out").output, HasSubstr(": 0 entries computed"));
  EXPECT_EQ(content(home_ / "out/raw.jsonl"), raw);
}

TEST_F(CompareCommand, ResultsOfAnotherSuiteAreLeftAlone) {
  suite("\"ipopt\"", "", 1);
  ASSERT_EQ(run("compare suite.toml --out out").exit_code, 0);
  const std::string raw = content(home_ / "out/raw.jsonl");
  write(home_ / "other.toml", R"(solvers = ["ipopt"]
[[problem]]
name = "something else"
task = "task.toml"
formulation = "margin"
order = 25
)");
  const Outcome other = run("compare other.toml --out out");
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_THAT(other.output, HasSubstr("another suite"));
  EXPECT_EQ(content(home_ / "out/raw.jsonl"), raw);
}

/// Lines of raw data that begin with an entry, without what its place in the suite changes.
std::multiset<std::string> entries_of(const std::string& raw) {
  std::multiset<std::string> entries;
  std::istringstream in(raw);
  for (std::string line; std::getline(in, line);) {
    auto row = nlohmann::ordered_json::parse(line);
    if (row["record"] != "run" && row["record"] != "problem") continue;
    row.erase("index");
    row.erase("case");
    entries.insert(row.dump());
  }
  return entries;
}

TEST_F(CompareCommand, ChangedSuiteComputesWhatTheChangeTouches) {
  suite(R"(["ipopt", "nlopt-slsqp"])", "", 1);
  const Outcome first = run("compare suite.toml --out out");
  ASSERT_EQ(first.exit_code, 0) << first.output;
  EXPECT_THAT(first.output, HasSubstr("20 entries computed")) << "4 references and 4 problems x 2 starts x 2 solvers";
  const std::string raw = content(home_ / "out/raw.jsonl"), as_it_was = content(home_ / "suite.toml");
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string text = as_it_was;
    text.replace(text.find(from), from.size(), to);
    write(home_ / "suite.toml", text);
    return run("compare suite.toml --out out").output;
  };
  EXPECT_THAT(changed("title = \"Mini\"", "title = \"Other words\"\naccuracy = 1e-3"),
              HasSubstr(": 0 entries computed"))
      << "what is judged afterwards needs no new runs";
  EXPECT_THAT(changed("\"ipopt\", \"nlopt-slsqp\"", "\"clp\", \"nlopt-slsqp\", \"ipopt\""),
              HasSubstr("8 entries computed"))
      << "the new solver's runs";
  EXPECT_THAT(changed("order = 10", "order = 11"), HasSubstr("10 entries computed"))
      << "the second problem's two references and 8 runs";
  EXPECT_THAT(changed("time_limit_s = 60", "time_limit_s = 50"), HasSubstr("20 entries computed"))
      << "all: the time limit is told to every solver";
  write(home_ / "suite.toml", as_it_was);
  const Outcome back = run("compare suite.toml --out out");
  EXPECT_THAT(back.output, HasSubstr(": 0 entries computed")) << "nothing that was done is lost";
  EXPECT_EQ(entries_of(content(home_ / "out/raw.jsonl")), entries_of(raw));
}

TEST_F(CompareCommand, ChangedAfterAKillItKeepsWhatWasDone) {
  suite(R"(["ipopt", "nlopt-slsqp"])", "", 1);
  const pid_t child = start("compare suite.toml --out out --workers 1");
  const auto lines = [&] {
    const std::string journal = content(home_ / "out/comparison.journal");
    return std::count(journal.begin(), journal.end(), '\n');
  };
  int status = 0;
  while (lines() < 8 && ::waitpid(child, &status, WNOHANG) == 0)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  ::kill(child, SIGKILL);
  ::waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status));
  const auto done = lines() - 1;
  suite(R"(["ipopt", "nlopt-slsqp"])", "accuracy = 1e-3", 1);
  const Outcome next = run("compare suite.toml --out out");
  ASSERT_EQ(next.exit_code, 0) << next.output;
  EXPECT_THAT(next.output, HasSubstr(fmt::format("{} from an earlier run", done)));
  for (const auto& item : fs::directory_iterator(home_ / "out"))
    EXPECT_THAT(item.path().filename().string(), Not(HasSubstr("journal")));
}

TEST_F(CompareCommand, SaysWhatItSolvesAndWhatCameOfIt) {
  write(home_ / "suite.toml", R"(solvers = ["ipopt", "nlopt-slsqp"]
repeats = 1
[[problem]]
name = "undelayed"
task = "task.toml"
formulation = "margin"
order = 30
[[problem]]
name = "delayed"
task = "task.toml"
formulation = "margin"
order = 30
delay_samples = 12
)");
  const Outcome r = run("compare suite.toml --out out");
  ASSERT_EQ(r.exit_code, 0) << r.output;
  EXPECT_THAT(r.output,
              HasSubstr("problem \"undelayed\": margin without delay_samples: asks for the least corner error "
                        "without any delay"));
  EXPECT_THAT(r.output, Not(HasSubstr("problem \"delayed\"")));
  EXPECT_THAT(content(home_ / "out/problems.csv"),
              ::testing::AllOf(HasSubstr("taps of least corner error without any delay"),
                               HasSubstr("taps of least corner error at delay 12")));
  // The table: two runs each, both reached the proved optimum.
  EXPECT_THAT(r.output, ::testing::ContainsRegex("solver +runs +reached"));
  EXPECT_THAT(r.output, ::testing::ContainsRegex("\nipopt +2 +2 +0"));
}

// Properties that the shipped comparison claims.

}  // namespace
