#include <filesystem>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "compare_command.hpp"

// The answers of `accdec compare` to wrong suites, to other solvers and to variants.

namespace {

using accdec::testing::CompareCommand;
namespace fs = std::filesystem;
using accdec::testing::content;
using accdec::testing::Outcome;
using accdec::testing::write;
using ::testing::HasSubstr;
using ::testing::Not;

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
  refuse("instances suite.toml --format nl --out ''", "the name of the folder for results is empty");
  refuse("compare suite.toml", "--out DIR");
  refuse("compare --redraw none", "no raw data");
  fs::create_directories(home_ / "mine");
  write(home_ / "mine/raw.jsonl", "years of work\n");
  fs::create_directories(home_ / "packed");
  write(home_ / "packed/raw.jsonl.xz", "");
  refuse("compare --redraw packed", "unpack them with xz -dk packed/raw.jsonl.xz");
  refuse("compare --redraw mine", "raw.jsonl: line 1: not a record of a comparison");
  suite();
  refuse("compare suite.toml --out mine", "holds no suite; nothing was changed");
  EXPECT_EQ(content(home_ / "mine/raw.jsonl"), "years of work\n");
}

// A suite asks about tasks, so it cannot contradict them.
TEST_F(CompareCommand, SuitesThatContradictTheirTasksAreRefused) {
  const std::string given = content(home_ / "task.toml") + "delay_samples = 4\n";
  write(home_ / "given.toml", given + "[[corner]]\nname = \"B\"\nangle_deg = 95\nfeed_in_mm_min = 6000\n");
  write(home_ / "orders.toml", given + "[design]\norder_min = 12\norder_max = 20\n");
  const struct {
    const char *lines, *place, *words;
  } problems[] = {
      {"task = \"given.toml\"\norder = 30\ndelay_samples = [2, 3]", "suite.toml:6:18: ",
       "`delay_samples` = 2 contradicts the task, which gives 4 to corner A; allowed is 4, or no `delay_samples`"},
      {"task = \"given.toml\"\norder = 30\ndelay_samples = 2", "suite.toml:6:17: ", "contradicts the task"},
      {"task = \"task.toml\"\norder = 30\ndelay_samples = 2.5",
       "suite.toml:6:17: ", "`delay_samples` = 2.5 must be a whole number"},
      {"task = \"given.toml\"\norder = 30\ndelay_samples = [4, 2.5]", "suite.toml:6:21: ", "must be a whole number"},
      {"task = \"orders.toml\"\norder = 11", "suite.toml:5:9: ", "allowed is order >= its [design] order_min = 12"},
      {"task = \"orders.toml\"\norder = 21", "suite.toml:5:9: ", "allowed is order <= its [design] order_max = 20"}};
  const auto outcome_of = [&](const std::string& lines) {
    write(home_ / "suite.toml",
          "solvers = [\"ipopt\"]\n[[problem]]\nname = \"x\"\n" + lines + "\nformulation = [\"margin\", \"design\"]\n");
    return run("instances suite.toml --format mps --out none");
  };
  for (const auto& problem : problems) {
    const Outcome refused = outcome_of(problem.lines);
    EXPECT_EQ(refused.exit_code, 2) << refused.output;
    EXPECT_THAT(refused.output, HasSubstr(problem.place));
    EXPECT_THAT(refused.output, HasSubstr(problem.words));
    EXPECT_FALSE(fs::exists(home_ / "none"));
  }
  write(home_ / "suite.toml",
        "solvers = [\"ipopt\"]\n[[problem]]\nname = \"x\"\ntask = \"task.toml\"\norder = 30\ndelay_samples = 3\n"
        "formulation = \"design\"\n");
  const Outcome no_use = run("instances suite.toml --format mps --out none");
  EXPECT_EQ(no_use.exit_code, 2);
  EXPECT_THAT(no_use.output, HasSubstr("suite.toml:6:17: a design chooses its delays"));
  const Outcome allowed = outcome_of("task = \"given.toml\"\norder = 30\ndelay_samples = [4, 3.0]");
  EXPECT_EQ(allowed.exit_code, 0) << allowed.output;
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
  EXPECT_THAT(own.output, HasSubstr("16 entries that the suite no longer asks for"));
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

}  // namespace
