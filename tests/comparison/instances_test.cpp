#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <numbers>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <accdec/comparison/suite_instances.hpp>
#include <accdec/exact/exact.hpp>
#include <accdec/verify.hpp>

#include "instances_fixture.hpp"

// Instances are read back by programs that are not ours: cbc, glpsol, csdp, cvxopt, and gjh_asl_json for .nl.
// HiGHS has no reader in SciPy: it solves what a reader in Python reads.

namespace accdec {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using testing::Instances;
using testing::output_of;

// The optimum of an outer approximation by tangents lies below that of the cones, by at most cos(pi/64).
TEST_F(Instances, LinearProgramsAreReadBackWithTheSameOptimum) {
  const json manifest = write_all("mps");
  for (const char* problem : {"small corner", "vibration"}) {
    const json entry = find(manifest, problem, "margin");
    const std::string file = "mps/" + entry["file"].get<std::string>();
    const auto by_cbc = read_back("cbc", file), by_glpk = read_back("glpsol", file);
    if (!by_cbc || !by_glpk) GTEST_SKIP() << "cbc or glpsol is not installed";
    const double radius = std::stod(*by_cbc), proved = std::sqrt(entry["optimum"]["upper"].get<double>());
    EXPECT_NEAR(std::stod(*by_glpk), radius, 1e-6 * radius) << problem;
    if (const auto by_highs = read_back("highs", file); by_highs) {
      EXPECT_NEAR(std::stod(*by_highs), radius, 1e-6 * radius) << problem;
    }
    EXPECT_LE(radius, proved * (1.0 + 1e-6)) << problem;
    // The tangents also widen the cones of vibration, whose effect on the error has no such bound.
    if (problem == std::string("small corner")) {
      EXPECT_GE(radius, proved * std::cos(std::numbers::pi / 64) * (1.0 - 1e-4));
    }
  }
  const std::string empty = "mps/" + find(manifest, "short", "margin")["file"].get<std::string>();
  EXPECT_EQ(read_back("cbc", empty), "infeasible");
  EXPECT_EQ(read_back("glpsol", empty), "infeasible");
  EXPECT_EQ(read_back("highs", empty).value_or("infeasible"), "infeasible");
  EXPECT_THAT(find(manifest, "power", "margin")["reason"], HasSubstr("is not convex"));
}

// The tolerance is at most 1/cos(pi/64) times too large, so the exact method at both tolerances encloses the answer.
TEST_F(Instances, WholeChoiceHasTheOptimumOfTheExactMethod) {
  const json entry = find(write_all("mps"), "small corner", "design");
  EXPECT_EQ(entry["class"], "mixed-integer linear program (big-M)");
  const auto found = read_back("cbc", "mps/" + entry["file"].get<std::string>());
  if (!found) GTEST_SKIP() << "cbc is not installed";
  Task task = read_task((home_ / "task.toml").string());
  task.design.order_min = task.design.order_max = 14;
  const double exact = design_exact(task).objective() / task.sample_period;
  *task.corners[0].error_max /= std::cos(std::numbers::pi / 64);
  const double wider = design_exact(task).objective() / task.sample_period;
  EXPECT_LE(std::stod(*found), exact + 1e-6);
  EXPECT_GE(std::stod(*found), wider - 1e-6);
  EXPECT_NEAR(entry["optimum"]["upper"].get<double>(), exact, 1e-9);
  const testing::Outcome proof = run("verify mps/" + entry["optimum"]["certificate"].get<std::string>());
  EXPECT_EQ(proof.exit_code, 0) << proof.output;
}

TEST_F(Instances, ConeProgramsHaveTheSameOptimumInTwoSolvers) {
  const json cones = write_all("cbf"), matrices = write_all("dat-s");
  for (const char* problem : {"small corner", "vibration"}) {
    const json entry = find(cones, problem, "margin");
    const auto by_cvxopt = read_back("cvxopt", "cbf/" + entry["file"].get<std::string>());
    if (!by_cvxopt) GTEST_SKIP() << "python3-cvxopt is not installed";
    const double optimum = std::stod(*by_cvxopt), width = 1e-6 * std::max(1.0, optimum);
    EXPECT_GE(optimum, entry["optimum"]["lower"].get<double>() - width);
    EXPECT_LE(optimum, entry["optimum"]["upper"].get<double>() + width);
    const auto by_csdp = read_back("csdp", "dat-s/" + find(matrices, problem, "margin")["file"].get<std::string>());
    if (!by_csdp) GTEST_SKIP() << "coinor-csdp is not installed";
    double first = 0.0, second = 0.0;
    std::istringstream(*by_csdp) >> first >> second;
    EXPECT_LE(std::abs(first - second), 1e-5 * std::max(1.0, optimum));
    EXPECT_GE(optimum, std::min(first, second) - width);
    EXPECT_LE(optimum, std::max(first, second) + width);
  }
  EXPECT_EQ(read_back("cvxopt", "cbf/" + find(cones, "short", "margin")["file"].get<std::string>()), "infeasible");
  EXPECT_EQ(read_back("csdp", "dat-s/" + find(matrices, "short", "margin")["file"].get<std::string>()), "infeasible");
  EXPECT_THAT(find(matrices, "small corner", "design")["reason"], HasSubstr("no integer variables"));
  EXPECT_THAT(find(cones, "small corner", "delay")["reason"], HasSubstr("is not convex"));
}

// A global solver that reads AMPL's files finds the optima that the exact method proves. It is not in Debian 12.
TEST_F(Instances, NlHasTheOptimumOfAnAmplSolver) {
  const json manifest = write_all("nl");
  for (const json& entry : manifest["instances"]) {
    if (entry["formulation"] == "delay") continue;  // SCIP takes longer than a test
    const auto found = read_back("scip", "nl/" + entry["file"].get<std::string>());
    if (!found) GTEST_SKIP() << "scip is not installed";
    const json& optimum = entry["optimum"];
    SCOPED_TRACE(entry["file"]);
    if (optimum["proof"] != "proved") {
      EXPECT_EQ(*found, "infeasible");
      continue;
    }
    const double value = std::stod(*found), width = 1e-6 * std::max(1.0, value);
    EXPECT_GE(value, optimum["lower"].get<double>() - width);
    EXPECT_LE(value, optimum["upper"].get<double>() + width);
  }
}

std::string underlined(std::string name) {
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
}

/// Row names of a file are keys of what reads it.
void expect_different_names(const nlp::Problem& problem) {
  std::set<std::string> names;
  for (int r = 0; r < problem.num_rows(); ++r)
    EXPECT_TRUE(names.insert(underlined(problem.row_name(r))).second) << problem.row_name(r);
}

/// Rows, Jacobian and Hessian with multipliers 1 at the start, against AMPL's reader.
void expect_same_functions(const nlp::Problem& problem, const std::vector<double>& x, const json& theirs) {
  const auto n = static_cast<std::size_t>(problem.num_variables()), m = static_cast<std::size_t>(problem.num_rows());
  std::vector<double> rows(m), jacobian(problem.jacobian_pattern().size()), hessian(problem.hessian_pattern().size());
  problem.rows(x, rows);
  problem.jacobian(x, jacobian);
  problem.hessian(x, 1.0, std::vector<double>(m, 1.0), hessian);
  const auto name = [&](int i) { return underlined(problem.variable_name(i)); };
  const auto near = [](double a, double b) { return std::abs(a - b) <= 1e-9 * std::max(1.0, std::abs(a)); };
  for (std::size_t r = 0; r < m; ++r) {
    const std::string row = underlined(problem.row_name(static_cast<int>(r)));
    // Constants of rows stand in their bounds.
    const auto& quadratic = dynamic_cast<const QuadraticProblem&>(problem);
    const double constant = quadratic.polynomial(static_cast<int>(r)).affine.constant;
    EXPECT_PRED2(near, rows[r], theirs["constraints"].at(row).get<double>() + constant) << row;
  }
  std::size_t checked = 0;
  for (std::size_t e = 0; e < jacobian.size(); ++e) {
    const nlp::Entry entry = problem.jacobian_pattern()[e];
    const std::string key = underlined(problem.row_name(entry.row)) + "_" + name(entry.column);
    if (!theirs["constraints' jacobian"].contains(key)) {
      EXPECT_EQ(jacobian[e], 0.0) << key;
      continue;
    }
    EXPECT_PRED2(near, jacobian[e], theirs["constraints' jacobian"][key].get<double>()) << key;
    ++checked;
  }
  EXPECT_GT(checked, n);
  const json& curvature = theirs["objective function"].begin().value()["lagrangian hessian"];
  std::size_t curved = 0;
  for (std::size_t e = 0; e < hessian.size(); ++e) {
    const nlp::Entry entry = problem.hessian_pattern()[e];
    const std::string one = name(entry.row) + "_" + name(entry.column),
                      other = name(entry.column) + "_" + name(entry.row);
    const std::string key = curvature.contains(one) ? one : other;
    if (!curvature.contains(key)) {
      EXPECT_EQ(hessian[e], 0.0) << key;
      continue;
    }
    EXPECT_PRED2(near, hessian[e], curvature[key].get<double>()) << key;
    ++curved;
  }
  EXPECT_GT(curved, 0u);
}

TEST_F(Instances, NlHasOurValuesAndDerivatives) {
  if (output_of("command -v gjh_asl_json").empty()) GTEST_SKIP() << "gjh-asl-json is not installed";
  const json manifest = write_all("nl");
  const Suite suite = read_suite((home_ / "suite.toml").string());
  std::size_t compared = 0;
  for (std::size_t i = 0; i < suite.cases.size(); ++i) {
    const comparison::ComparisonCase subject(suite.cases[i]);
    const std::string file = manifest["instances"][i]["file"];
    const std::string stem = file.substr(0, file.size() - 3), answer = (home_ / "answer.json").string();
    output_of("cd '" + (home_ / "nl").string() + "' && gjh_asl_json '" + stem + "' 'rows=" + stem +
              ".row' 'cols=" + stem + ".col' 'json=" + answer + "' 2>&1");
    std::string text = testing::content(answer);
    // It prints what JSON does not have.
    for (std::size_t at = 0; (at = text.find("Infinity", at)) != std::string::npos;) text.replace(at, 8, "1e300");
    const json theirs = json::parse(text);
    SCOPED_TRACE(stem);
    const json& values = theirs["initial evaluations"];
    if (suite.cases[i].question == comparison::Question::design) {
      EXPECT_GT(theirs["problem statistics"]["no. of linear binary variables"], 14);
      const instances::Choice choice = comparison::choice_of(subject);
      expect_different_names(choice.problem);
      expect_same_functions(choice.problem, choice.start, values);
    } else {
      expect_same_functions(*subject.problem(false), subject.start(false, 0, 1), values);
    }
    ++compared;
  }
  EXPECT_EQ(compared, 9u);
}

// Shortest delays of N + 1 and N + 2 samples, and corners where only limits, or zeros among the taps, set the delay. No
// such file has a cone that binds, so an outer approximation by tangents has the optimum itself.
TEST_F(Instances, WholeChoiceHasEveryDelayOfTheExactMethod) {
  const struct {
    const char *name, *axes, *corner;
    int order;
    const char* angle = "90";
  } tasks[] = {{"straight", "acceleration_max_mm_s2 = 1000\n", "error_max_um = 0\n", 12, "180"},
               {"stop", "acceleration_max_mm_s2 = 1000\n", "error_max_um = 20\n", 7},
               {"exact", "acceleration_max_mm_s2 = 1000\n", "error_max_um = 0\n", 12},
               {"limits", "acceleration_max_mm_s2 = 1000\n", "", 12},
               {"jerk", "acceleration_max_mm_s2 = 3000\njerk_max_mm_s3 = 400000\n", "", 8}};
  std::string suite = "solvers = [\"exact\"]\nstarts = 1\nrepeats = 1\n";
  for (const auto& t : tasks) {
    testing::write(
        home_ / (std::string(t.name) + ".toml"),
        fmt::format("sample_period_ms = 2\n[[axis]]\n{}[[corner]]\nname = \"A\"\nangle_deg = {}\nheading_deg = "
                    "-45\nfeed_in_mm_min = 1200\n{}[[corner]]\nname = \"slow\"\nangle_deg = "
                    "90\nfeed_in_mm_min = 60\nerror_max_um = 500\n",
                    t.axes, t.angle, t.corner));
    suite += fmt::format("[[problem]]\nname = \"{0}\"\ntask = \"{0}.toml\"\nformulation = \"design\"\norder = {1}\n",
                         t.name, t.order);
  }
  testing::write(home_ / "suite.toml", suite);
  const json manifest = write_all("mps");
  for (const auto& t : tasks) {
    const json entry = find(manifest, t.name, "design");
    ASSERT_EQ(entry["optimum"]["proof"], "proved") << t.name;
    const auto found = read_back("highs", "mps/" + entry["file"].get<std::string>());
    if (!found) GTEST_SKIP() << "python3-scipy is not installed";
    EXPECT_NEAR(std::stod(*found), entry["optimum"]["upper"].get<double>(), 1e-6) << t.name;
  }
}

TEST_F(Instances, FolderHoldsOneFormatAndNoStaleFiles) {
  // Without a delay to choose there is nothing to minimise.
  const json given = find(write_all("nl"), "given", "delay")["optimum"];
  EXPECT_EQ(given["proof"], "proved");
  EXPECT_EQ(given["upper"], 0.0);
  const std::string before = testing::content(home_ / "nl/manifest.json");
  const testing::Outcome other = run("instances suite.toml --out nl --format mps");
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_THAT(other.output, HasSubstr("nl: holds instances as nl"));
  EXPECT_EQ(testing::content(home_ / "nl/manifest.json"), before);
  std::string text = testing::content(home_ / "suite.toml");
  testing::write(home_ / "suite.toml", text.replace(text.find("name = \"short\""), 14, "name = \"tiny\""));
  write_all("nl");
  EXPECT_TRUE(std::filesystem::exists(home_ / "nl/tiny.margin.1.nl"));
  for (const char* ending : {".nl", ".row", ".col"})
    EXPECT_FALSE(std::filesystem::exists(home_ / (std::string("nl/short.margin.1") + ending))) << ending;
  EXPECT_TRUE(std::filesystem::exists(home_ / "nl/small-corner.margin.1.row"));
  // An edited manifest is not believed.
  json edited = json::parse(testing::content(home_ / "nl/manifest.json"));
  edited["instances"][0]["file"] = "..";
  testing::write(home_ / "nl/manifest.json", edited.dump());
  write_all("nl");
  edited["format"] = 3;
  testing::write(home_ / "nl/manifest.json", edited.dump());
  const testing::Outcome unknown = run("instances suite.toml --out nl --format nl");
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.output, HasSubstr("no word as `format`"));
}

TEST_F(Instances, RefusesWhatItCannotWrite) {
  testing::Outcome outcome = run("instances suite.toml --out x --format lp");
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.output, HasSubstr("nl"));
  outcome = run("instances suite.toml --out /proc/nowhere --format nl");
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.output, HasSubstr("/proc/nowhere"));
  std::filesystem::create_directories(home_ / "mine");
  testing::write(home_ / "mine" / "letter", "keep");
  outcome = run("instances suite.toml --out mine --format nl");
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_EQ(testing::content(home_ / "mine" / "letter"), "keep");
}

}  // namespace
}  // namespace accdec
