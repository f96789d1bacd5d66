#include <algorithm>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "instances_fixture.hpp"

// Tasks of which a suite's questions are not: files leave them out, and comparisons ask nobody.

namespace accdec {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using testing::Instances;
using testing::task_text;

/// Lines of one kind in the raw data of a comparison.
std::vector<json> records(const std::string& raw, const std::string& kind) {
  std::vector<json> rows;
  std::istringstream lines(raw);
  for (std::string line; std::getline(lines, line);) {
    if (json row = json::parse(line); row.value("record", "") == kind) rows.push_back(std::move(row));
  }
  return rows;
}

// At 29 mm/s no filter stays within the tolerance of 40 um. How far off the best one is, is a problem with an answer.
// The corner turns by 85 degrees at 41.67 mm/s. Without a delay no sample is slower than 41.67 cos(42.5 deg) = 30.7 mm/s.
// So 29 mm/s can be held, and no filter holds 31 mm/s.
TEST_F(Instances, ASmallestSpeedBeyondTheToleranceIsWritten) {
  testing::write(home_ / "slow.toml", std::string(task_text) + "speed_min_mm_s = 29\n");
  testing::write(home_ / "suite.toml",
                 "solvers = [\"ipopt\"]\n[[problem]]\nname = \"speed\"\ntask = \"slow.toml\"\norder = 14\n"
                 "formulation = [\"margin\", \"delay\", \"design\"]\ndelay_samples = 0\n"
                 "[[problem]]\nname = \"too fast\"\ntask = \"slow.toml\"\norder = 14\n"
                 "formulation = [\"margin\", \"delay\"]\ndelay_samples = 0\n"
                 "set = { \"corner.A.speed_min_mm_s\" = 31 }\n");
  const json manifest = write_all("nl");
  for (const char* written : {"margin", "delay"}) {
    const json entry = find(manifest, "speed", written);
    EXPECT_FALSE(entry["file"].is_null()) << entry;
    EXPECT_EQ(entry["optimum"]["proof"], "proved") << entry;
    const json none = find(manifest, "too fast", written);
    EXPECT_FALSE(none["file"].is_null()) << none;
    EXPECT_EQ(none["optimum"]["proof"], "infeasible proved") << none;
  }
  EXPECT_GT(find(manifest, "speed", "margin")["optimum"]["lower"], 1.0);
  const json design = find(manifest, "speed", "design");
  EXPECT_TRUE(design["file"].is_null()) << design;
  EXPECT_THAT(design["reason"], HasSubstr("smallest speed A and corner error A"));
}

// The whole choice is of free taps and delays. A task that narrows them is another problem, so nobody answers this one.
TEST_F(Instances, TasksThatNarrowTapsOrDelaysAreLeftOut) {
  const struct {
    const char *name, *lines, *key;
  } tasks[] = {{"family", "[design]\nfamily = \"averages\"\n", "[design] family"},
               {"bits", "[design]\ncoefficient_bits = 15\n", "[design] coefficient_bits"},
               {"given", "[filter]\nkind = \"boxcar\"\norder = 12\n", "[filter]"},
               {"control", "[controller]\nname = \"sinumerik-840d\"\n", "[controller] name"}};
  std::string suite = "solvers = [\"exact\", \"ipopt\"]\nstarts = 1\nrepeats = 1\n";
  for (const auto& t : tasks) {
    testing::write(home_ / (std::string(t.name) + ".toml"), std::string(task_text) + t.lines);
    suite +=
        fmt::format("[[problem]]\nname = \"{0}\"\ntask = \"{0}.toml\"\nformulation = \"design\"\norder = 14\n", t.name);
  }
  testing::write(home_ / "suite.toml", suite);
  const json manifest = write_all("nl");
  for (const auto& t : tasks) {
    const json entry = find(manifest, t.name, "design");
    EXPECT_TRUE(entry["file"].is_null()) << entry;
    EXPECT_THAT(entry.value("reason", ""), HasSubstr(t.key));
    EXPECT_EQ(entry["optimum"]["proof"], "bound");
    EXPECT_TRUE(entry["optimum"]["certificate"].is_null()) << entry;
  }
  const testing::Outcome outcome = run("compare suite.toml --out out");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
  const std::string raw = testing::content(home_ / "out/raw.jsonl");
  for (const json& problem : records(raw, "problem")) EXPECT_EQ(problem["proof"], "bound") << problem;
  const std::vector<json> runs = records(raw, "run");
  const auto refused = std::ranges::count_if(runs, [](const json& row) { return row["claim"] == "refused"; });
  EXPECT_EQ(refused, 2 * 4);
}

// No row of a file knows a control's smoothing. The exact method does, and its certificate is checked.
TEST_F(Instances, DesignsBehindASmoothingHaveAnOptimumWithoutAFile) {
  testing::write(home_ / "task.toml", std::string(task_text) + "[controller]\nprefilter_taps = [0.5, 0.5]\n");
  const json entry = find(write_all("nl"), "small corner", "design");
  EXPECT_TRUE(entry["file"].is_null()) << entry;
  EXPECT_THAT(entry.value("reason", ""), HasSubstr("prefilter_taps"));
  EXPECT_EQ(entry["optimum"]["proof"], "proved");
  const testing::Outcome checked = run("verify nl/" + entry["optimum"].value("certificate", ""));
  EXPECT_EQ(checked.exit_code, 0) << checked.output;
}

/// A corner of tolerance zero beside that of `task_text`.
std::string with_exact_stop(const std::string& keys = "") {
  return std::string(task_text) +
         "\n[[corner]]\nname = \"B\"\nangle_deg = 90\nfeed_in_mm_min = 1000\nerror_max_um = 0\n" + keys;
}

/// `task_text` with dry friction and a limit on the force. Axis x reverses unless the corner is flat.
std::string with_friction(const char* angle) {
  std::string text = task_text;
  text.replace(text.find("[[axis]]\n"), 9, "[[axis]]\nmass_kg = 40\ncoulomb_N = 60\nforce_max_N = 400\n");
  return text.replace(text.find("angle_deg = 95"), 14, fmt::format("angle_deg = {}", angle));
}

// Margins and delays are of free taps, and no row of theirs states an exact stop. It needs none where the delay is as
// long as the filter. Rows count dry friction both ways, as no row knows when an axis reverses.
TEST_F(Instances, NobodyIsAskedWhatIsNotTheTask) {
  const std::string stop = std::string(task_text) + "contour_max_um = 0\n";
  const struct {
    const char *name, *formulation, *reason;
    std::string task;
  } tasks[] = {{"family", "margin", "[design] family", std::string(task_text) + "[design]\nfamily = \"averages\"\n"},
               {"given", "delay", "[filter]", std::string(task_text) + "[filter]\nkind = \"boxcar\"\norder = 12\n"},
               {"contour", "margin", "contour_max_um = 0", stop},
               {"later", "delay", "contour_max_um = 0", stop + "delay_samples = 13\n"},
               {"error", "margin", "error_max_um = 0", with_exact_stop()},
               {"free stop", "delay", "error_max_um = 0", with_exact_stop()},
               {"short stop", "delay", "error_max_um = 0", with_exact_stop("delay_samples = 13\n")},
               {"long stop", "delay", nullptr, with_exact_stop("delay_samples = 14\n")},
               {"reverses", "margin", "friction both ways", with_friction("95")},
               {"reversal", "delay", "friction both ways", with_friction("95")},
               {"onwards", "margin", nullptr, with_friction("150")},
               {"stops", "margin", nullptr, stop + "delay_samples = 14\n"}};
  std::string suite = "solvers = [\"ipopt\"]\nstarts = 1\nrepeats = 1\n";
  for (const auto& t : tasks) {
    testing::write(home_ / (std::string(t.name) + ".toml"), t.task);
    suite += fmt::format("[[problem]]\nname = \"{0}\"\ntask = \"{0}.toml\"\nformulation = \"{1}\"\norder = 14\n",
                         t.name, t.formulation);
  }
  testing::write(home_ / "suite.toml", suite);
  const json manifest = write_all("nl");
  const testing::Outcome outcome = run("compare suite.toml --out out");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
  const std::string raw = testing::content(home_ / "out/raw.jsonl");
  const std::vector<json> runs = records(raw, "run"), problems = records(raw, "problem");
  ASSERT_EQ(runs.size(), std::size(tasks));
  for (std::size_t i = 0; i < std::size(tasks); ++i) {
    const json entry = find(manifest, tasks[i].name, tasks[i].formulation);
    const json& answer = runs[i];
    const std::string reason = tasks[i].reason ? tasks[i].reason : "";
    EXPECT_EQ(entry["file"].is_null(), !reason.empty()) << entry;
    EXPECT_EQ(answer["claim"] == "refused", !reason.empty()) << answer;
    if (reason.empty()) continue;
    EXPECT_THAT(entry.value("reason", ""), HasSubstr(reason));
    EXPECT_EQ(entry["optimum"]["proof"], "bound");
    EXPECT_TRUE(entry["optimum"]["upper"].is_null()) << entry;
    EXPECT_THAT(answer.value("message", ""), HasSubstr(reason));
    EXPECT_THAT(problems[i].value("method", ""), HasSubstr(reason));
  }
}

// Only margins and delays need a corner with an error. At an exact stop, the taps that are not 0 lie within d + 1
// samples. Axis y moves with 2500/60 mm/s sin(115 deg), so no tap may be above 0.159: 7 of them are needed, and d = 6.
TEST_F(Instances, DesignsNeedNoTolerance) {
  std::string text = task_text;
  text.replace(text.find("error_max_um = 40"), 17, "error_max_um = 0");
  text.replace(text.find("jerk_max_mm_s3 = 1500000"), 24, "");
  testing::write(home_ / "stop.toml", text);
  testing::write(home_ / "long.toml", text + "delay_samples = 14\n");
  testing::write(home_ / "suite.toml", R"(solvers = ["ipopt", "exact"]
starts = 1
repeats = 1
[[problem]]
name = "stop"
task = "stop.toml"
formulation = ["margin", "delay", "design"]
order = 14
[[problem]]
name = "long"
task = "long.toml"
formulation = ["margin", "delay"]
order = 14
)");
  const json manifest = write_all("mps");
  for (const char* question : {"margin", "delay"}) {
    EXPECT_THAT(find(manifest, "stop", question).value("reason", ""), HasSubstr("exact stop"));
    EXPECT_THAT(find(manifest, "long", question).value("reason", ""),
                HasSubstr("needs a corner with error_max_um > 0"));
  }
  const json design = find(manifest, "stop", "design");
  EXPECT_EQ(design["file"], "stop.design.1.mps");
  EXPECT_EQ(design["optimum"]["upper"], 6 + 15.0);
  const testing::Outcome outcome = run("compare suite.toml --out out");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
  const std::vector<json> runs = records(testing::content(home_ / "out/raw.jsonl"), "run");
  ASSERT_EQ(runs.size(), 10U);
  for (const json& row : runs) EXPECT_EQ(row["claim"] == "refused", row["case"] != 2) << row;
}

// Files bound a band at single frequencies. The exact method bounds all of it.
TEST_F(Instances, RelationSaysWhatIsOfABand) {
  std::string text = testing::content(home_ / "suite.toml");
  text.replace(text.find("formulation = \"margin\""), 22, "formulation = [\"margin\", \"design\"]");
  testing::write(home_ / "suite.toml", text);
  const json manifest = write_all("nl");
  EXPECT_EQ(find(manifest, "small corner", "margin")["relation"], "the same problem");
  EXPECT_EQ(find(manifest, "vibration", "margin")["relation"],
            "the same problem; a mode's band is bounded at single frequencies, and at the ends of its damping, in the "
            "optimum here as well");
  EXPECT_THAT(find(manifest, "vibration", "design")["relation"].get<std::string>(), HasSubstr(": a lower bound"));
}

// A task's own delay is one of its choices.
TEST_F(Instances, MarginIsAskedAtTheDelayOfTheTask) {
  testing::write(home_ / "task.toml", std::string(task_text) + "delay_samples = 5\n");
  EXPECT_EQ(find(write_all("mps"), "small corner", "margin")["asks"], "taps of least corner error at delay 5");
}

}  // namespace
}  // namespace accdec
