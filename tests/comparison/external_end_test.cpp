#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <accdec/comparison/comparison_run.hpp>
#include <accdec/comparison/external_solver.hpp>
#include <accdec/comparison/suite_instances.hpp>
#include <accdec/instances/instance.hpp>

#include "compare_command.hpp"
#include "support/tasks.hpp"

// How programs of others end, and how their answers are judged.

namespace accdec {
namespace {

using comparison::External;
using comparison::ExternalSolver;
using ::testing::HasSubstr;

/// A corner at 0.1 m/s and order 40, at which only the boxcar holds the acceleration.
comparison::CaseSpec boxcar_corner() {
  Axis axis;
  axis.acceleration_max = 0.1 / 41e-3;
  comparison::CaseSpec spec;
  spec.name = "boxcar";
  spec.task = testing::plane_task(axis, testing::plane_corner("A", 90.0, 0.0, 0.1, 0.1), 100e-6);
  spec.order = 40;
  spec.delays = {0};
  return spec;
}

/// Its error over the tolerance, squared: each leg is short of the corner by v T (1 + .. + 20) / 41.
const double boxcar_sigma = 2.0 * std::pow(1e-4 * 210.0 / 41.0 / 100e-6, 2);

class MarginAnswer : public testing::CommandInFolder {
 protected:
  /// The record of a program that answers these taps and this sigma.
  batch::Row answered(double sigma, double moved = 0.0) {
    const comparison::ComparisonCase subject(boxcar_corner());
    const nlp::Problem& problem = *subject.problem(false);
    std::vector<double> x = subject.start(false, 0, 1);
    for (int i = 0; i < problem.num_variables(); ++i) {
      double& value = x[static_cast<std::size_t>(i)];
      if (i < 40) value = (i + 1) / 41.0;
      if (problem.variable_name(i) == "sigma") value = sigma;
    }
    x[19] += moved;
    std::string text = "solved\n";
    for (const double value : x) text += fmt::format("{}\n", value);
    testing::write(home_ / "answer.txt", text);
    comparison::Competitor mine;
    mine.name = "mine";
    mine.solver = "external";
    mine.form = comparison::Competitor::Form::sparse;
    mine.external = std::make_shared<ExternalSolver>(
        External{"mine", "sh -c ': {cbf}; cat {suite}/answer.txt'", "cbf", "values", home_.string()});
    comparison::ComparisonSettings settings;
    settings.solvers = {mine};
    return comparison::Comparison(settings, {boxcar_corner()}).run(1);
  }
};

// Solvers hold the row of the error relative to its size. The sigma that their taps need follows without them.
TEST_F(MarginAnswer, SigmaIsWhatItsTapsNeed) {
  for (const double missing : {0.0, 2.6e-7, 9e-5}) {
    const batch::Row row = answered(boxcar_sigma * (1.0 - missing));
    EXPECT_EQ(row["verdict"], "feasible") << row;
    EXPECT_NEAR(row["objective"].get<double>(), boxcar_sigma, 1e-9 * boxcar_sigma) << row;
  }
  const batch::Row larger = answered(2.0 * boxcar_sigma);
  EXPECT_EQ(larger["verdict"], "feasible");
  EXPECT_NEAR(larger["objective"].get<double>(), 2.0 * boxcar_sigma, 1e-9 * boxcar_sigma);
}

TEST_F(MarginAnswer, SigmaThatNoToleranceExplainsIsBroken) {
  const std::map<double, double> violations{{1.0 - 2e-4, 2e-4}, {0.5, 0.5}, {0.0, 1.0}};
  for (const auto& [part, violation] : violations) {
    const batch::Row row = answered(boxcar_sigma * part);
    EXPECT_EQ(row["verdict"], "infeasible") << row;
    EXPECT_NEAR(row["violation"].get<double>(), violation, 1e-3 * violation) << row;
  }
  const batch::Row tiny = answered(1e-310);
  EXPECT_EQ(tiny["claim"], "solved") << tiny;
  EXPECT_EQ(tiny["verdict"], "infeasible") << tiny;
  EXPECT_EQ(tiny["claimed_objective"].get<double>(), 1e-310);
}

// A step of B_20 moves two taps by as much, and one of them beyond the 1/41 that the acceleration allows.
TEST_F(MarginAnswer, LinearRowsHaveTheirTolerance) {
  EXPECT_EQ(answered(boxcar_sigma, 5e-8)["verdict"], "feasible");
  const batch::Row row = answered(boxcar_sigma, 1e-6);
  EXPECT_EQ(row["verdict"], "infeasible") << row;
  EXPECT_NEAR(row["violation"].get<double>(), 1e-6, 1e-9) << row;
}

/// Variables that the format leaves out follow from its columns: at a start, distances from the taps.
TEST(DatS, VariablesWithoutAColumnFollowFromTheOthers) {
  const comparison::ComparisonCase subject(boxcar_corner());
  const std::vector<double> start = subject.start(false, 0, 1);
  const instances::Text text = instances::dat_s_text(comparison::instance_of(subject));
  EXPECT_EQ(text.columns.size() + text.solved.size(), start.size());
  EXPECT_GE(text.solved.size(), 2u);
  std::vector<double> x(start.size(), std::nan(""));
  for (const int i : text.variables) x[static_cast<std::size_t>(i)] = start[static_cast<std::size_t>(i)];
  for (const auto& [i, form] : text.solved) x[static_cast<std::size_t>(i)] = form(x);
  for (std::size_t i = 0; i < x.size(); ++i) EXPECT_NEAR(x[i], start[i], 1e-9 * std::max(1.0, std::abs(start[i]))) << i;
}

/// Cells of a line of CSV, some of them in quotes.
std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '"') {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      cells.emplace_back();
    } else {
      cells.back() += c;
    }
  }
  return cells;
}

class ProgramEnds : public testing::CompareCommand {
 protected:
  /// Compares a script for each name with Ipopt, at a limit of 1 s, on a problem that has an answer. $1 is the problem.
  void compare(const std::map<std::string, std::string>& scripts) {
    std::string text = "solvers = [\"ipopt\"]\nstarts = 1\nrepeats = 1\ntime_limit_s = 1\nkill_after_s = 6\n";
    for (const auto& [name, script] : scripts) {
      testing::write(home_ / (name + ".sh"), script);
      text += fmt::format(
          "[[external]]\nname = \"{0}\"\ncommand = \"sh '{{suite}}/{0}.sh' {{cbf}}\"\nreads = \"cbf\"\nanswer = "
          "\"values\"\n",
          name);
    }
    testing::write(home_ / "ends.toml", text +
                                            "[[problem]]\nname = \"small\"\ntask = \"task.toml\"\nformulation = "
                                            "\"margin\"\norder = 30\ndelay_samples = 12\n");
    const testing::Outcome outcome = run("compare ends.toml --out out --workers 2");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
  }
  /// A solver's cells by their headings.
  std::map<std::string, std::string> line_of(const std::string& solver, const std::string& file) {
    std::istringstream lines(testing::content(home_ / "out" / file));
    std::vector<std::string> head;
    for (std::string line; std::getline(lines, line);) {
      const std::vector<std::string> cells = cells_of(line);
      if (head.empty()) head = cells;
      if (cells.front() != solver) continue;
      std::map<std::string, std::string> row;
      for (std::size_t i = 0; i < std::min(head.size(), cells.size()); ++i) row[head[i]] = cells[i];
      return row;
    }
    ADD_FAILURE() << solver;
    return {};
  }
};

TEST_F(ProgramEnds, LateLiesAndCrashesCount) {
  compare({{"quick lie", "echo infeasible"},
           {"late lie", "sleep 1.3; echo infeasible"},
           {"late ray", "sleep 1.3; echo unbounded"},
           {"late give-up", "sleep 1.3; echo failed"},
           {"late crash", "sleep 1.3; kill -SEGV $$"},
           {"crash", "echo infeasible; kill -SEGV $$"},
           {"hangs", "sleep 600"},
           {"prints", "yes"}});
  for (const char* liar : {"quick lie", "late lie", "late ray"}) {
    const auto board = line_of(liar, "leaderboard.csv");
    EXPECT_EQ(board.at("wrong claims"), "1") << liar;
    EXPECT_EQ(board.at("claims"), "1") << liar;
    EXPECT_EQ(board.at("out of time"), "0") << liar;
  }
  EXPECT_EQ(line_of("late give-up", "leaderboard.csv").at("out of time"), "1");
  const std::string runs = testing::content(home_ / "out/runs.csv");
  for (const char* crashed : {"late crash", "crash"}) {
    EXPECT_EQ(line_of(crashed, "summary.csv").at("killed or crashed"), "1") << crashed;
    EXPECT_EQ(line_of(crashed, "leaderboard.csv").at("wrong claims"), "0") << crashed;
    EXPECT_THAT(runs, HasSubstr(fmt::format(",{},crashed,", crashed)));
  }
  for (const char* killed : {"hangs", "prints"})
    EXPECT_EQ(line_of(killed, "summary.csv").at("killed or crashed"), "1") << killed;
  for (const char* ended : {"quick lie", "late lie", "late give-up", "ipopt"})
    EXPECT_EQ(line_of(ended, "summary.csv").at("killed or crashed"), "0") << ended;
  EXPECT_EQ(line_of("hangs", "leaderboard.csv").at("out of time"), "1");
}

TEST_F(ProgramEnds, StandardErrorIsNoAnswer) {
  compare({{"warns", "echo 'warning: deprecated' >&2; echo infeasible"},
           {"silent", "echo infeasible >&2"},
           {"floods", "yes >&2"},
           {"own code", "echo infeasible; exit 255"}});
  const std::string runs = testing::content(home_ / "out/runs.csv");
  EXPECT_THAT(runs, HasSubstr(",warns,infeasible,"));
  EXPECT_THAT(runs, HasSubstr("exit code 0: warning: deprecated"));
  EXPECT_THAT(runs, HasSubstr(",silent,failed,"));
  EXPECT_THAT(runs, HasSubstr("printed more than 1000000 bytes"));
  EXPECT_THAT(runs, HasSubstr(",own code,infeasible,")) << "no signal has the number 127";
}

// csdp's solution file begins with the values of the columns.
TEST_F(ProgramEnds, SemidefiniteProgramsReadDatS) {
  if (std::system("command -v csdp > /dev/null") != 0) GTEST_SKIP() << "coinor-csdp is not installed";
  testing::write(home_ / "mine.sh", "csdp \"$1\" y > log\necho solved\nhead -1 y\n");
  testing::write(home_ / "ends.toml", R"(solvers = ["ipopt"]
starts = 1
repeats = 1
feasibility = 1e-6
[[external]]
name = "mine"
command = "sh {suite}/mine.sh {dat-s}"
reads = "dat-s"
answer = "values"
[[problem]]
name = "small"
task = "task.toml"
formulation = ["margin", "delay", "design"]
order = 34
)");
  const testing::Outcome outcome = run("compare ends.toml --out out --workers 2");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
  const std::string runs = testing::content(home_ / "out/runs.csv");
  EXPECT_THAT(runs, HasSubstr("small,margin,1,0,mine,solved,reference reached,yes"));
  EXPECT_THAT(runs, HasSubstr("small,delay,1,0,mine,refused"));
  EXPECT_THAT(runs, HasSubstr("small,design,1,0,mine,refused"));
}

TEST_F(ProgramEnds, SuitesThatCanNeverWorkAreRefused) {
  const auto refused = [&](const std::string& lines, const std::string& reason) {
    suite(R"(["ipopt"])", "[[external]]\nname = \"mine\"\n" + lines);
    const testing::Outcome outcome = run("compare suite.toml --out none");
    EXPECT_EQ(outcome.exit_code, 2) << lines;
    EXPECT_THAT(outcome.output, HasSubstr(reason)) << lines;
  };
  refused("command = \"s {cbf}\"\nreads = \"cbf\"\n", "this one reads \"cbf\": allowed are \"values\" and \"names\"");
  refused("command = \"s {mps}\"\nreads = \"mps\"\nanswer = \"sol\"\n", "suite.toml:11:10: `answer` = \"sol\"");
  for (const char* sign : {">", "2>&1", "|", "&&", ";", "<", ">{answer}"})
    refused(fmt::format("command = \"s {{nl}} {} o\"\n", sign), "in `command` would be an argument, as no shell runs");
  const std::map<std::string, std::string> places{{"nl", "f"}};
  EXPECT_THAT(comparison::command_words("sh -c 's {nl} > o' '|' a>b -k=2>1", places),
              ::testing::ElementsAre("sh", "-c", "s f > o", "|", "a>b", "-k=2>1"));
}

}  // namespace
}  // namespace accdec
