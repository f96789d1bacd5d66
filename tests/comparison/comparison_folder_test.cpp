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
#include <accdec/solvers/solver.hpp>

#include "support/command_fixture.hpp"
#include "support/paths.hpp"

// The comparison as a user runs it, killed, resumed and drawn anew.

namespace {

namespace fs = std::filesystem;
using accdec::testing::content;
using accdec::testing::Outcome;
using accdec::testing::write;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* tables[] = {"problems.csv", "summary.csv", "confusion.csv", "runs.csv", "pairs.csv"};

class CompareCommand : public accdec::testing::CommandInFolder {
 protected:
  void SetUp() override {
    CommandInFolder::SetUp();
    write(home_ / "task.toml", R"(sample_period_ms = 1.0
[[axis]]
acceleration_max_mm_s2 = 6000
jerk_max_mm_s3 = 500000
[[corner]]
name = "A"
angle_deg = 95
feed_in_mm_min = 6000
error_max_um = 50
)");
    suite();
  }
  void suite(const std::string& solvers = R"(["ipopt", "nlopt-slsqp", "nlopt-cobyla", "clp"])",
             const std::string& more = "", int repeats = 5) {
    write(home_ / "suite.toml", fmt::format(R"(title = "Mini"
solvers = {}
starts = 2
repeats = {}
time_limit_s = 60
evaluation_limit = 200
{}
[[problem]]
name = "small"
task = "task.toml"
formulation = ["margin", "delay"]
order = 30
delay_samples = 12
[[problem]]
name = "short"
task = "task.toml"
formulation = ["margin", "design"]
order = 10
expected = "infeasible"
)",
                                            solvers, repeats, more));
  }
};

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
  EXPECT_EQ(r.exit_code, 1) << r.output;
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

TEST_F(CompareCommand, BadInputIsSaidAndNothingIsTouched) {
  const auto refuse = [&](const std::string& arguments, const std::string& words) {
    const Outcome r = run(arguments);
    EXPECT_EQ(r.exit_code, 2) << r.output;
    EXPECT_THAT(r.output, HasSubstr(words));
    EXPECT_FALSE(fs::exists(home_ / "none"));
  };
  suite(R"(["ipotp"])");
  refuse("compare suite.toml --out none",
         R"(suite.toml:2:12: unknown solver "ipotp"; did you mean "ipopt"? known are ipopt, ipopt-lbfgs)");
  suite(R"(["nlopt-mma/reduced"])");
  refuse("compare suite.toml --out none", "unknown solver \"nlopt-mma/reduced\"");  // it has no other form
  suite(R"("all")", "time_limit = 3");
  refuse("compare suite.toml --out none", "suite.toml:7:1: unknown key `time_limit`");
  suite(R"("all")", "targets = [0]");
  refuse("compare suite.toml --out none", "suite.toml:7:12");
  suite("\"ipopt\"");
  write(home_ / "suite.toml",
        content(home_ / "suite.toml") +
            "[[problem]]\nname = \"x\"\ntask = \"gone.toml\"\norder = 5\nformulation = \"margin\"\n");
  refuse("compare suite.toml --out none", "gone.toml does not exist");
  suite("\"ipopt\"");
  write(home_ / "suite.toml",
        content(home_ / "suite.toml") +
            "[[problem]]\nname = \"x\"\ntask = \"task.toml\"\norder = 5\nformulation = \"least\"\n");
  refuse("compare suite.toml --out none", "unknown formulation \"least\"; known are margin, delay, design");
  suite("\"ipopt\"", "sizes = [1, 2, 1]");
  refuse("compare suite.toml --out none", "suite.toml:7:9: size 1 stands twice");
  suite("\"ipopt\"");
  write(home_ / "suite.toml", content(home_ / "suite.toml") + "set = { \"corner.*.error_max_um\" = -1 }\n");
  refuse("compare suite.toml --out none", "suite.toml:20:7: the task with these keys set: ");
  suite("\"ipopt\"");
  EXPECT_THAT(run("compare suite.toml --out /proc/none").output, HasSubstr("/proc/none: cannot be created: "));
  refuse("compare suite.toml", "--out DIR");
  refuse("compare --redraw none", "no raw data");
  fs::create_directories(home_ / "mine");
  write(home_ / "mine/raw.jsonl", "years of work\n");
  refuse("compare --redraw mine", "raw.jsonl: line 1: not a record of a comparison");
  suite();
  refuse("compare suite.toml --out mine", "holds no suite; nothing was changed");
  EXPECT_EQ(content(home_ / "mine/raw.jsonl"), "years of work\n");
}

TEST_F(CompareCommand, OtherSolversThanTheSuites) {
  suite("\"ipopt\"", "", 1);
  const Outcome done = run("compare suite.toml --out out --solvers clp,nlopt-slsqp/reduced");
  ASSERT_EQ(done.exit_code, 0) << done.output;
  EXPECT_THAT(
      content(home_ / "out/summary.csv"),
      ::testing::AllOf(HasSubstr("\nclp,"), HasSubstr("\nnlopt-slsqp/reduced,"), ::testing::Not(HasSubstr("ipopt"))));
  EXPECT_THAT(content(home_ / "out/manifest.json"), HasSubstr("--solvers clp,nlopt-slsqp/reduced"));
  // With the suite's own solver only its runs are missing, and the others' are not lost.
  const Outcome own = run("compare suite.toml --out out");
  EXPECT_THAT(own.output, HasSubstr("8 entries computed")) << "four problems from two starts";
  EXPECT_THAT(own.output, HasSubstr("4 from an earlier run")) << "the references";
  EXPECT_THAT(own.output, HasSubstr("16 entries of an earlier form of the suite"));
  EXPECT_THAT(content(home_ / "out/summary.csv"), ::testing::AllOf(HasSubstr("\nipopt,"), Not(HasSubstr("\nclp,"))));
  EXPECT_THAT(run("compare suite.toml --out out --solvers clp,nlopt-slsqp/reduced").output,
              HasSubstr(": 0 entries computed"));
  const auto refused = [&](const std::string& solvers, const std::string& reason) {
    const Outcome outcome = run("compare suite.toml --out none --solvers " + solvers);
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.output, HasSubstr(reason));
  };
  refused("clp,nlopt-mma/reduced", "--solvers: unknown solver \"nlopt-mma/reduced\"; ");
  refused("iopt", "--solvers: unknown solver \"iopt\"; did you mean \"ipopt\"?");
  refused("clp,ipopt,clp", "--solvers: solver \"clp\" stands twice");
}

// A variant's option must reach the library: one iteration is not enough, and the claim says so.
TEST_F(CompareCommand, VariantsAreSolversWithOptionsOfTheirOwn) {
  const auto with = [&](const std::string& variant) {
    suite("\"ipopt\"", "", 1);
    write(home_ / "suite.toml", content(home_ / "suite.toml") + "[[variant]]\n" + variant);
  };
  with(
      "name = \"one step\"\nsolver = \"ipopt\"\nform = \"reduced\"\noptions = { max_iter = 1, mu_strategy = "
      "\"monotone\" }\n");
  const Outcome done = run("compare suite.toml --out out");
  ASSERT_EQ(done.exit_code, 0) << done.output;
  EXPECT_THAT(content(home_ / "out/summary.csv"), HasSubstr("\none step,"));
  const std::string raw = content(home_ / "out/raw.jsonl");
  EXPECT_THAT(raw, HasSubstr(R"("options":{"max_iter":"1","mu_strategy":"monotone"})"));
  EXPECT_THAT(content(home_ / "out/runs.csv"), HasSubstr("one step,evaluation limit"));
  with("name = \"two\"\nsolver = \"ipotp\"\n");
  EXPECT_THAT(run("compare suite.toml --out none").output,
              HasSubstr("unknown solver \"ipotp\"; did you mean \"ipopt\"?"));
  with("name = \"two\"\nsolver = \"nlopt-mma\"\noptions = { dual_maxevals = 3 }\n");
  EXPECT_THAT(run("compare suite.toml --out none").output, HasSubstr("dual_maxevals"));
  with("name = \"two\"\nsolver = \"nlopt-mma\"\nform = \"reduced\"\n");
  EXPECT_THAT(run("compare suite.toml --out none").output, HasSubstr("takes one form only"));
  with("name = \"ipopt\"\nsolver = \"nlopt-mma\"\n");
  EXPECT_THAT(run("compare suite.toml --out none").output, HasSubstr("taken already"));
  EXPECT_FALSE(fs::exists(home_ / "none"));
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

// What the shipped comparison claims to be.
TEST(ShippedSuite, HasThirtyProblemsOfEveryKindAndThreeSizes) {
  const accdec::Suite suite = accdec::read_suite(accdec::test_support::source_folder() + "/problems/suite/full.toml");
  std::map<std::string, std::set<int>> sizes;
  std::set<std::string> families;
  int largest = 0;
  for (const auto& c : suite.cases) {
    sizes[c.name].insert(c.size);
    families.insert(c.family);
    largest = std::max(largest, c.order);
  }
  EXPECT_GE(sizes.size(), 30u);
  EXPECT_GE(std::count_if(sizes.begin(), sizes.end(), [](const auto& s) { return s.second.size() >= 3; }), 8);
  EXPECT_THAT(families, ::testing::IsSupersetOf({"convex", "power and speed", "many corners", "infeasible",
                                                 "badly scaled", "large", "design"}));
  EXPECT_GE(largest, 1000);
  EXPECT_GE(suite.settings.repeats, 5);
  std::set<std::string> solvers;
  for (const auto& competitor : suite.settings.solvers) solvers.insert(competitor.solver);
  EXPECT_EQ(solvers.size(), accdec::solvers::registry().size());
  for (const char* name : {"quick", "patience", "forms", "options"})
    EXPECT_NO_THROW(accdec::read_suite(accdec::test_support::source_folder() + "/problems/suite/" + name + ".toml"))
        << name;
}

}  // namespace
