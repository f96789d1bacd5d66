#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <unistd.h>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <accdec/comparison/comparison_case.hpp>
#include <accdec/comparison/external_answer.hpp>
#include <accdec/comparison/external_solver.hpp>
#include <accdec/comparison/suite_file.hpp>

#include "compare_command.hpp"

namespace accdec {
namespace {

using comparison::External;
using comparison::ExternalSolver;
using solvers::Claim;
using ::testing::HasSubstr;

comparison::CaseSpec corner() {
  comparison::CaseSpec spec;
  spec.task = read_task(test_support::source_folder() + "/problems/corner/acceleration-jerk.toml");
  spec.order = 30;
  spec.delays = {12};
  return spec;
}

/// A solver that is a script of the shell; $1 is the problem, $2 the answer.
class ExternalScript : public testing::CommandInFolder {
 protected:
  solvers::Result answer_of(const std::string& script, const std::string& answer = "values", double seconds = 20.0,
                            double grace = 1.0) {
    testing::write(home_ / "solver.sh", script);
    const comparison::ComparisonCase subject(corner());
    const nlp::Problem& problem = *subject.problem(false);
    solvers::Options options;
    options.time_limit = seconds;
    return ExternalSolver({"mine", "sh {suite}/solver.sh {nl} {answer}", "nl", answer, home_.string(), 0, grace})
        .solve(problem, subject.start(false, 0, 1), options);
  }
  /// Seconds a call takes.
  template <class Call>
  static double time_of(const Call& call) {
    const auto began = std::chrono::steady_clock::now();
    call();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  }
};

// The start of the .nl file as an answer: the section x has as many lines as variables.
constexpr const char* echo_start = R"(n=$(sed -n 's/^x\([0-9]*\)$/\1/p' "$1")
values=$(sed -n "/^x$n\$/,/^r\$/p" "$1" | sed '1d;$d' | cut -d' ' -f2)
)";

TEST_F(ExternalScript, AnswersComeBackInTheOrderOfTheProblem) {
  const comparison::ComparisonCase subject(corner());
  const std::vector<double> start = subject.start(false, 0, 1);
  const auto values = answer_of(std::string(echo_start) + "printf 'solved\\n%s\\n' \"$values\" > \"$2\"\n");
  EXPECT_EQ(values.claim, Claim::solved) << values.message;
  EXPECT_EQ(values.x, start);
  const auto read = comparison::read_values("solved\r\n+0.5\r\n-1\r\n", 2);
  EXPECT_EQ(read.claim, Claim::solved);
  EXPECT_EQ(read.x, (std::vector<double>{0.5, -1.0}));
  EXPECT_DOUBLE_EQ(values.claimed_objective, subject.problem(false)->objective(start));
  testing::write(home_ / "printing.sh", std::string(echo_start) + "printf 'solved\\n%s\\n' \"$values\"\n");
  const auto printed = ExternalSolver({"printing", "sh {suite}/printing.sh {nl}", "nl", "values", home_.string()})
                           .solve(*subject.problem(false), start);
  EXPECT_EQ(printed.claim, Claim::solved) << printed.message;
  EXPECT_EQ(printed.x, start);
  const auto sol = answer_of(std::string(echo_start) + R"(
printf 'mine 1.0: nearly there\n\nOptions\n3\n1\n1\n0\n7\n0\n%s\n%s\n%s\nobjno 0 100\n' "$n" "$n" "$values" > "$2"
)",
                             "sol");
  EXPECT_EQ(sol.claim, Claim::acceptable) << sol.message;
  EXPECT_EQ(sol.x, start);
  EXPECT_THAT(sol.message, HasSubstr("nearly there"));
}

TEST_F(ExternalScript, BadAnswersFailWithTheReason) {
  const struct {
    const char *script, *message;
  } bad[] = {{"exit 3", "exit code 3"},
             {"echo help >&2", "help"},
             {"echo solved > \"$2\"; kill -SEGV $$", "ended by signal 11"},
             {"printf 'solved\\n1\\n2\\n' > \"$2\"", "2 values"},
             {"printf 'solved\\n1\\n' > \"$2\"", "has 1 value; the problem"},
             {"yes 1 | head -100000 | (echo solved; cat) > \"$2\"", "more than"},
             {"printf 'solved\\n1\\nzwei\\n' > \"$2\"", "\"zwei\" where a number belongs"},
             {"printf 'done\\n' > \"$2\"", "no claim"},
             {"echo solved > \"$2\"", "claims a solution, but its answer has no values"},
             {"mkfifo \"$2\"", "wrote no answer"},
             {"ln -s /dev/zero \"$2\"", "wrote no answer"},
             {"mkdir \"$2\"", "wrote no answer"}};
  for (const auto& [script, message] : bad) {
    const auto result = answer_of(script);
    EXPECT_EQ(result.claim, Claim::failed) << script;
    EXPECT_EQ(result.verification.verdict, solvers::Verdict::none) << script;
    EXPECT_THAT(result.message, HasSubstr(message)) << script;
  }
  for (const char* number : {"nan", "inf", "1e999"}) {
    const auto result = answer_of(std::string(echo_start) + "(echo solved; echo " + number +
                                  "; echo \"$values\" | tail -n +2) > \"$2\"\n");
    EXPECT_EQ(result.claim, Claim::invalid_number) << number;
    EXPECT_EQ(result.verification.verdict, solvers::Verdict::none) << number;
  }
  for (const char* text : {"", "Options\n", "no options", "x\n\nOptions\n3\n1\n1\n0\n7\n0\n5\n5\n"}) {
    EXPECT_THROW(comparison::read_sol(text, 33), std::invalid_argument) << text;
  }
  const auto missing = ExternalSolver({"gone", "/nowhere/solver {nl}", "nl", "sol", "."})
                           .solve(*comparison::ComparisonCase(corner()).problem(false),
                                  comparison::ComparisonCase(corner()).start(false, 0, 1));
  EXPECT_EQ(missing.claim, Claim::failed);
  EXPECT_THAT(missing.message, HasSubstr("cannot be started: No such file"));
}

TEST_F(ExternalScript, HangingPrintingAndForkingEndsWithinTheLimit) {
  solvers::Result result;
  EXPECT_LT(time_of([&] { result = answer_of("sleep 600", "values", 0.5); }), 5.0);
  EXPECT_EQ(result.claim, Claim::time_limit);
  EXPECT_THAT(result.message, HasSubstr("ran longer than 1.5 s"));
  EXPECT_LT(time_of([&] { result = answer_of("yes", "values", 30.0); }), 10.0);
  EXPECT_EQ(result.claim, Claim::failed);
  EXPECT_THAT(result.message, HasSubstr("printed more than 1000000 bytes"));
  // Processes in sessions of their own, which outlive the script and those who started them.
  const std::string mark = "4321" + std::to_string(::getpid());
  EXPECT_LT(time_of([&] {
              result = answer_of("for i in 1 2 3; do (setsid sleep " + mark + " &) ; done; setsid -f sleep " + mark +
                                     "; sleep 0.2; echo failed > \"$2\"",
                                 "values", 30.0);
            }),
            10.0);
  EXPECT_EQ(result.claim, Claim::failed);
  EXPECT_NE(
      std::system(("cat /proc/[0-9]*/cmdline 2> /dev/null | tr '\\0' ' ' | grep -q 'slee[p] " + mark + "'").c_str()),
      0);
}

// A program that keeps the limit ends at the limit, and writes what it has then.
TEST_F(ExternalScript, AnswersAtTheLimitAreKept) {
  const auto late = answer_of(
      "sleep 0.6\n" + std::string(echo_start) + "printf 'solved\\n%s\\n' \"$values\" > \"$2\"\n", "values", 0.5, 20.0);
  EXPECT_EQ(late.claim, Claim::time_limit) << late.message;
  EXPECT_EQ(late.x, comparison::ComparisonCase(corner()).start(false, 0, 1));
  EXPECT_GT(late.wall_time, 0.5);
}

TEST_F(ExternalScript, MemoryIsLimited) {
  testing::write(home_ / "solver.sh",
                 "head -c 300000000 /dev/zero | tail -c 300000000 > /dev/null && echo failed > \"$2\"\n");
  const comparison::ComparisonCase subject(corner());
  const nlp::Problem& problem = *subject.problem(false);
  External mine{"mine", "sh {suite}/solver.sh {nl} {answer}", "nl", "values", home_.string()};
  const auto free = ExternalSolver(mine).solve(problem, subject.start(false, 0, 1));
  EXPECT_THAT(free.message, ::testing::Not(HasSubstr("wrote no answer")));
  mine.memory_max = 200;
  const auto limited = ExternalSolver(mine).solve(problem, subject.start(false, 0, 1));
  EXPECT_EQ(limited.claim, Claim::failed);
  EXPECT_THAT(limited.message, HasSubstr("wrote no answer"));
  EXPECT_THAT(limited.message, HasSubstr("may have 200 MB each"));
}

class ExternalCommand : public testing::CompareCommand {};

TEST_F(ExternalCommand, RunGoesOnWithABrokenSolver) {
  suite(R"(["ipopt"])", R"([[external]]
name = "hangs"
command = "tail -f {nl}"
[[external]]
name = "gone"
command = "/nowhere/solver {nl}"
)",
        1);
  const std::string text = testing::content(home_ / "suite.toml");
  std::string quick = text;
  quick.replace(quick.find("time_limit_s = 60"), 17, "time_limit_s = 1");
  testing::write(home_ / "suite.toml", quick);
  const testing::Outcome outcome = run("compare suite.toml --out out --workers 2");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
  const std::string raw = testing::content(home_ / "out" / "raw.jsonl");
  EXPECT_THAT(raw, HasSubstr("ran longer than 3 s"));
  EXPECT_THAT(raw, HasSubstr("cannot be started: No such file"));
}

/// One run of the raw data.
nlohmann::json run_of(const std::string& raw, const std::string& solver, int problem) {
  std::istringstream lines(raw);
  for (std::string line; std::getline(lines, line);) {
    nlohmann::json row = nlohmann::json::parse(line);
    if (row.value("record", "") == "run" && row.value("solver", "") == solver && row.value("case", -1) == problem)
      return row;
  }
  return {};
}

constexpr const char* design_problem = R"(
[[problem]]
name = "design"
task = "task.toml"
formulation = "design"
order = 34
)";

// Whole designs: a script per fault. Each is recorded with its reason, and the run goes on to the exact method.
TEST_F(ExternalCommand, FaultsOnDesignsAreRecordedAndTheRunGoesOn) {
  const struct {
    const char *name, *script, *claim, *message;
  } faults[] = {{"nan", "printf 'optimal\\nX1 nan\\n'", "invalid number", "not finite"},
                {"length", "printf 'optimal\\nX99999 1\\n'", "failed", "names X99999"},
                {"silent", "true", "failed", "names no variable"},
                {"hangs", "sleep 600", "time limit", "ran longer than 3 s"},
                {"prints", "yes X1 1", "failed", "printed more than"},
                {"forks", "for i in 1 2 3; do setsid -f sleep 600; done; echo infeasible", "infeasible", ""},
                {"lies", "echo optimal; echo X1 1", "solved", "which no tolerance explains"},
                {"ray", "echo Problem is unbounded", "unbounded", ""}};
  std::string text = "solvers = [\"exact\"]\nstarts = 1\nrepeats = 1\ntime_limit_s = 1\n";
  for (const auto& fault : faults) {
    testing::write(home_ / (std::string(fault.name) + ".sh"), fault.script);
    text += fmt::format(
        "[[external]]\nname = \"{0}\"\ncommand = \"sh {{suite}}/{0}.sh {{mps}}\"\nreads = \"mps\"\nanswer = "
        "\"names\"\n",
        fault.name);
  }
  testing::write(home_ / "faults.toml", text + design_problem);
  const testing::Outcome outcome = run("compare faults.toml --out out --workers 2");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
  const std::string raw = testing::content(home_ / "out/raw.jsonl");
  for (const auto& fault : faults) {
    const nlohmann::json row = run_of(raw, fault.name, 0);
    EXPECT_EQ(row["claim"], fault.claim) << row;
    EXPECT_FALSE(row.contains("objective")) << row;
    EXPECT_THAT(row.value("message", ""), HasSubstr(fault.message));
    EXPECT_LT(row.value("wall_time_s", 0.0), 5.0) << row;
  }
  EXPECT_EQ(run_of(raw, "exact", 0)["claim"], "solved");
  const std::string board = testing::content(home_ / "out/leaderboard.csv");
  EXPECT_THAT(board, HasSubstr("exact,accdec,100.0,1,1"));
  for (const char* wrong : {"lies,.*,0,1,0,0,1,0,0", "forks,.*,0,1,0,1,1,0,0", "ray,.*,0,1,0,0,1,0,0"})
    EXPECT_THAT(board, ::testing::ContainsRegex(wrong));
}

// Programs of Debian solve the same design from its MPS file. They have another method and another reader.
TEST_F(ExternalCommand, MixedIntegerProgramsFindTheOptimaOfTheExactMethod) {
  if (std::system("command -v cbc > /dev/null && command -v glpsol > /dev/null") != 0)
    GTEST_SKIP() << "coinor-cbc and glpk-utils are not installed";
  testing::write(home_ / "rivals.toml", R"(solvers = ["exact"]
starts = 1
repeats = 1
time_limit_s = 60
[[external]]
name = "cbc"
command = "cbc {mps} sec {seconds} solve solution {answer}"
reads = "mps"
answer = "names"
[[external]]
name = "glpsol"
command = "glpsol --freemps {mps} --tmlim {seconds} -o {answer}"
reads = "mps"
answer = "names"
[[hypercube]]
name = "small"
task = "task.toml"
count = 4
seed = 2
formulation = "design"
[hypercube.ranges]
"sample_period_ms" = [3, 5]
"corner.*.angle_deg" = [30, 150]
"corner.*.error_max_um" = [20, 200]
)");
  const testing::Outcome outcome = run("compare rivals.toml --out out --workers 2");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
  const std::string raw = testing::content(home_ / "out/raw.jsonl");
  for (int c = 0; c < 4; ++c) {
    const nlohmann::json exact = run_of(raw, "exact", c);
    ASSERT_EQ(exact["claim"], "solved") << exact;
    for (const char* program : {"cbc", "glpsol"}) {
      const nlohmann::json row = run_of(raw, program, c);
      EXPECT_EQ(row["claim"], "solved") << row;
      EXPECT_EQ(row["objective"], exact["objective"]) << row;
    }
  }
}

TEST_F(ExternalCommand, SuitesAreCheckedBeforeAnythingRuns) {
  suite(R"(["ipopt"])", "[[external]]\nname = \"a\"\ncommand = \"solver {cbf}\"\n");
  testing::Outcome outcome = run("compare suite.toml --out out");
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.output, HasSubstr("needs {nl}"));
  suite(R"(["ipopt"])", "[[external]]\nname = \"ipopt\"\ncommand = \"solver {nl}\"\n");
  outcome = run("compare suite.toml --out out");
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.output, HasSubstr("\"ipopt\" is a solver of `accdec solvers`"));
  suite(R"(["ipopt"])", "[[external]]\nname = \"a\"\ncommand = \"s {nl}\"\nreads = \"lp\"\n");
  outcome = run("compare suite.toml --out out");
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.output, HasSubstr("suite.toml:"));
  EXPECT_THAT(outcome.output, HasSubstr("cbf"));
  suite(R"(["ipopt"])", "[[external]]\nname = \"a\"\ncommand = \"s {nl}\"\nmemory_max_MB = 0\n");
  outcome = run("compare suite.toml --out out");
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.output, ::testing::ContainsRegex("suite.toml:[0-9]+:17: `memory_max_MB` = 0 is out of range"));
  suite(R"(["ipopt"])", "[[external]]\nname = \"a\"\ncommand = \"s {nl} {foo}\"\n");
  outcome = run("compare suite.toml --out out");
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.output, ::testing::ContainsRegex("suite.toml:[0-9]+:11: \"\\{foo\\}\" in `command` stands for "
                                                       "nothing; allowed are \\{answer\\}, \\{nl\\}"));
  EXPECT_FALSE(std::filesystem::exists(home_ / "out"));
}

// cvxopt, started as a program, reaches the reference of the exact method.
TEST_F(ExternalCommand, ShippedConeSolverReachesTheReference) {
  if (std::system("/usr/bin/python3 -c 'import cvxopt' > /dev/null 2>&1") != 0)
    GTEST_SKIP() << "python3-cvxopt is not installed";
  const testing::Outcome outcome =
      run("compare '" + test_support::source_folder() + "/problems/suite/external.toml' --out out --workers 2");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
  std::istringstream lines(testing::content(home_ / "out" / "raw.jsonl"));
  std::vector<double> upper;
  int reached = 0, refuted = 0;
  for (std::string line; std::getline(lines, line);) {
    const auto row = nlohmann::json::parse(line);
    if (row.value("record", "") == "problem") {
      const auto at = row["case"].get<std::size_t>();
      upper.resize(std::max(upper.size(), at + 1), NAN);
      if (row["upper"].is_number()) upper[at] = row["upper"];
    }
    if (row.value("record", "") != "run" || row.value("solver", "") != "cvxopt") continue;
    const auto at = row["case"].get<std::size_t>();
    if (std::isfinite(upper[at])) {
      EXPECT_EQ(row["claim"], "solved") << line;
      EXPECT_NEAR(row["objective"].get<double>(), upper[at], 1e-4 * upper[at]) << line;
      ++reached;
    } else {
      EXPECT_EQ(row["claim"], "infeasible") << line;
      ++refuted;
    }
  }
  EXPECT_EQ(reached, 6);
  EXPECT_EQ(refuted, 3);
}

}  // namespace
}  // namespace accdec
