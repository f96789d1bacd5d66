#include <algorithm>
#include <filesystem>
#include <map>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "support/run.hpp"

// A response behind the filter: every command considers it, refuses it by name, or reads no task at all.

namespace accdec {
namespace {

using ::testing::HasSubstr;
using Json = nlohmann::ordered_json;

constexpr const char* top = "sample_period_ms = 1\n";
constexpr const char* machine = "[[axis]]\nacceleration_max_mm_s2 = 6000\n";
constexpr const char* corner = "[[corner]]\nangle_deg = 95\nfeed_in_mm_min = 6000\nerror_max_um = 50\n";
constexpr const char* given = "delay_samples = 20\n[filter]\nkind = \"boxcar\"\norder = 20\n";
constexpr const char* servo = "servo_gain_1_s = 200\n";
/// No refusal advises what refuses it again.
constexpr const char* advice =
    "leave it out. `accdec evaluate`, `accdec design`, `accdec explain` and `accdec verify` consider it at the corners "
    "of a task";
constexpr const char* smoothing = "[controller]\nprefilter_taps = [0.25, 0.5, 0.25]\n";

/// Commands that read a task, with the arguments after it that let them come as far as the task.
const std::map<std::string, std::vector<std::string>> refusing{
    {"compare", {"suite.toml", "--out", "out"}},
    {"instances", {"suite.toml", "--out", "instances", "--format", "nl"}},
    {"identify", {"log.csv", "--task", "task.toml"}},
};
const std::vector<std::string> considering{"evaluate", "design", "explain", "verify",  "export", "plot",
                                           "optima",   "study",  "modes",   "program", "explore"};
const std::vector<std::string> without_tasks{"init",    "paper",      "generate", "controllers",
                                             "solvers", "completion", "schema"};

class ResponseOfTasks : public ::testing::Test {
 protected:
  std::string task(const std::string& axis, const std::string& end, const std::string& name = "task.toml") {
    return folder_.write(name, std::string(top) + machine + axis + corner + end);
  }
  TemporaryFolder folder_;
};

TEST_F(ResponseOfTasks, EveryCommandIsKnownHere) {
  std::istringstream help(run({"--help"}).out);
  bool listed = false;
  for (std::string line; std::getline(help, line);) {
    if (listed && line.starts_with("  ") && line[2] != ' ') {
      const std::string name = line.substr(2, line.find(' ', 2) - 2);
      const bool known = refusing.contains(name) ||
                         std::find(considering.begin(), considering.end(), name) != considering.end() ||
                         std::find(without_tasks.begin(), without_tasks.end(), name) != without_tasks.end();
      EXPECT_TRUE(known) << "does " << name << " consider a response behind the filter?";
    }
    if (line.starts_with("Subcommands:")) listed = true;
  }
  EXPECT_TRUE(listed);
}

TEST_F(ResponseOfTasks, OtherCommandsRefuseItByName) {
  for (const auto& [key, position] : std::map<std::string, std::string>{{"servo_gain_1_s", "4:18"},
                                                                        {"prefilter_taps", "9:18"},
                                                                        {"in_position_latency_ms", "12:26"},
                                                                        {"coulomb_N", "4:13"},
                                                                        {"power_total_max_W", "10:21"},
                                                                        {"regeneration_total_max_W", "11:28"}}) {
    if (key == "servo_gain_1_s") task(servo, "");
    if (key == "prefilter_taps") task("", smoothing);
    if (key == "in_position_latency_ms")
      task("",
           "[design]\nfamily = \"averages\"\n[controller]\ndelays = [\"in-position\"]\nin_position_latency_ms = 2\n");
    if (key == "coulomb_N") task("coulomb_N = 40\n", "");
    if (key == "power_total_max_W") task("mass_kg = 30\n", "[machine]\npower_total_max_W = 900\n");
    if (key == "regeneration_total_max_W") task("mass_kg = 30\n", "[machine]\n\nregeneration_total_max_W = 900\n");
    folder_.write("suite.toml",
                  "title = \"s\"\nsolvers = \"all\"\n[[problem]]\nname = \"a\"\ntask = \"task.toml\"\n"
                  "formulation = [\"margin\"]\norder = 20\n");
    for (const auto& [command, arguments] : refusing) {
      SCOPED_TRACE(command + " with " + key);
      // Comparisons consider all but the latency, and both responses stand behind a filter that is found.
      if (command == "identify" && (key == "prefilter_taps" || key == "in_position_latency_ms")) continue;
      if ((command == "compare" || command == "instances") && key != "in_position_latency_ms") continue;
      std::vector<std::string> call{command};
      for (const std::string& argument : arguments)
        call.push_back(argument.find('.') != std::string::npos || argument == "out" ? folder_.path(argument)
                                                                                    : argument);
      const Outcome outcome = run(call);
      EXPECT_EQ(outcome.code, 2);
      EXPECT_THAT(outcome.err, HasSubstr("task.toml:" + position + ": "));
      EXPECT_THAT(outcome.err, HasSubstr("`" + key + "` is not considered here; " + advice));
    }
  }
}

TEST_F(ResponseOfTasks, EvaluateDesignAndVerifyConsiderIt) {
  for (const std::string& end : {std::string(), std::string(smoothing)}) {
    const Outcome plain = run({"evaluate", task("", given), "--json", "-"});
    const Outcome behind = run({"evaluate", task(servo, given + end), "--json", "-"});
    EXPECT_GT(Json::parse(behind.out)["corners"][0]["corner_error_m"].get<double>(),
              Json::parse(plain.out)["corners"][0]["corner_error_m"].get<double>() + 10e-6);
    const std::string result = folder_.path("result.json");
    const Outcome design = run({"design", task(servo, end), "--json", result, "--no-baselines"});
    EXPECT_EQ(design.code, 0) << design.err;
    EXPECT_THAT(design.out, HasSubstr("settled"));
    const Outcome verified = run({"verify", result});
    EXPECT_EQ(verified.code, 0) << verified.out << verified.err;
    // The same result of another gain is none.
    Json other = Json::parse(folder_.read("result.json"));
    for (Json& axis : other["task"]["axis"]) axis["servo_gain_1_s"] = 150;
    EXPECT_EQ(run({"verify", folder_.write("other.json", other.dump())}).code, 1);
  }
}

/// Axes that differ and negative taps: every command takes them, and the results say that nothing is proved.
TEST_F(ResponseOfTasks, ResponsesWithoutAProofAreTakenEverywhere) {
  const std::string axes = std::string(servo) + "[[axis]]\nacceleration_max_mm_s2 = 6000\nservo_gain_1_s = 140\n";
  const std::string negative = "response_taps = [1.25, -0.25]\n";
  for (const std::string& response : {axes, negative}) {
    SCOPED_TRACE(response);
    const Outcome explained = run({"explain", task(response, ""), "--design-time-limit", "2"});
    EXPECT_EQ(explained.code, 0) << explained.err;
    EXPECT_THAT(explained.out, HasSubstr("not proved"));
    EXPECT_NE(run({"evaluate", task(response, given)}).code, 2);
    task(response, "");
    folder_.write("study.toml",
                  "title = \"s\"\ntask = \"task.toml\"\ncompute = [\"optimum\"]\ntime_limit_s = 2\n[[vary]]\n"
                  "name = \"error\"\nkey = \"corner.*.error_max_um\"\nvalues = [40, 80]\n");
    const Outcome study = run({"study", folder_.path("study.toml"), "--out", folder_.path("out")});
    EXPECT_EQ(study.code, 0) << study.err;
    EXPECT_THAT(folder_.read("out/rows.csv"), HasSubstr("feasible"));
    const std::string result = folder_.path("result.json");
    ASSERT_EQ(run({"design", task(response, ""), "--json", result, "--time-limit", "5"}).code, 0);
    EXPECT_EQ(run({"verify", result}).code, 0);
    EXPECT_EQ(run({"plot", result, "--out", folder_.path("figure.svg")}).code, 0);
    std::filesystem::remove_all(folder_.path("out"));
  }
  for (const std::string& response : {axes, negative}) {
    const Outcome tables = run({"design", task(response, ""), "--baselines", "--time-limit", "9"});
    EXPECT_EQ(tables.code, 0) << tables.err;
    EXPECT_THAT(tables.out, HasSubstr("two averages (trapezoidal acceleration"));
  }
}

/// Filters of families that are not symmetric are shorter here. The verifier refuses them where a task asks for
/// symmetry.
TEST_F(ResponseOfTasks, SymmetricTapsAreAskedOfFamiliesToo) {
  const std::string result = folder_.path("result.json");
  const std::string text =
      "sample_period_ms = 20\n[design]\norder_max = 12\nsymmetric = true\n"
      "[machine]\nregeneration_total_max_W = 2.5\n[[axis]]\nmass_kg = 27\nservo_gain_1_s = 66\n"
      "[[corner]]\nangle_deg = 90\nfeed_in_mm_min = 10000\n";
  ASSERT_EQ(run({"design", folder_.write("task.toml", text), "--json", result, "--time-limit", "5"}).code, 0);
  const Outcome verified = run({"verify", result});
  EXPECT_EQ(verified.code, 0) << verified.out << verified.err;
}

TEST_F(ResponseOfTasks, ExplainAndPlotConsiderIt) {
  const Outcome explained = run({"explain", task(servo, "")});
  EXPECT_EQ(explained.code, 0) << explained.err;
  EXPECT_THAT(explained.out, HasSubstr("corner error"));
  const std::string result = folder_.path("result.json"), data = folder_.path("figure.svg");
  ASSERT_EQ(run({"design", task(servo, ""), "--json", result, "--no-baselines"}).code, 0);
  const Outcome plotted = run({"plot", result, "--out", data});
  EXPECT_EQ(plotted.code, 0) << plotted.err;
  const std::string drawing = folder_.read("figure.svg");
  EXPECT_THAT(drawing, HasSubstr("command"));
  EXPECT_THAT(drawing, HasSubstr("motion"));
}

TEST_F(ResponseOfTasks, StudiesAndOptimaConsiderIt) {
  task(servo, "");
  folder_.write(
      "study.toml",
      "title = \"s\"\ntask = \"task.toml\"\ncompute = [\"optimum\", \"trapezoid\"]\n[[vary]]\nname = \"gain\"\n"
      "key = \"axis.*.servo_gain_1_s\"\nvalues = [100, 400]\n");
  const Outcome study = run({"study", folder_.path("study.toml"), "--out", folder_.path("out")});
  EXPECT_EQ(study.code, 0) << study.err;
  std::istringstream csv(folder_.read("out/rows.csv"));
  std::string head, slow, fast;
  std::getline(csv, head), std::getline(csv, slow), std::getline(csv, fast);
  const auto column = [&](const std::string& row) {
    std::istringstream names(head), cells(row);
    std::string name, cell;
    while (std::getline(names, name, ',') && std::getline(cells, cell, ',') && name != "optimum.cycle_time_ms") {
    }
    return std::stod(cell);
  };
  EXPECT_GT(column(slow), column(fast) + 1.0) << head;
  const Outcome optima = run({"optima", folder_.path("task.toml"), "--out", folder_.path("optima")});
  EXPECT_EQ(optima.code, 0) << optima.err;
}

/// Whole coefficients hold all limits behind a response, and lose little of the free taps.
TEST_F(ResponseOfTasks, WholeCoefficientsConsiderIt) {
  const std::string end = "[design]\ncoefficient_bits = 16\n", drive = "mass_kg = 50\nforce_max_N = 400\n";
  const std::string mode = "[[mode]]\nfrequency_Hz = 40\naxis = \"x\"\nresidual_max_um = 5\n";
  for (const std::string& text :
       {task(servo, end), task(servo, end + smoothing), task(drive + "coulomb_N = 40\n", end), task(drive, end + mode),
        task(drive + "force_speed_N = [[0, 400], [200, 350]]\n", end),
        task(drive, end + "[machine]\npower_total_max_W = 60\n"), task("response_taps = [0.5, 0.8, -0.3]\n", end)}) {
    SCOPED_TRACE(folder_.read("task.toml"));
    const std::string result = folder_.path("r.json");
    ASSERT_EQ(run({"design", text, "--json", result, "--time-limit", "6", "--no-baselines"}).code, 0);
    const Json json = Json::parse(folder_.read("r.json"));
    double sum = 0.0;
    for (const double tap : json["filter"]["taps"]) {
      EXPECT_EQ(tap * 65536.0, std::round(tap * 65536.0));
      sum += tap;
    }
    EXPECT_EQ(sum, 1.0);
    EXPECT_LE(json["cycle_time_s"], json["quantisation"]["unquantised_s"].get<double>() + 2e-3);
    EXPECT_EQ(run({"verify", result}).code, 0);
  }
  const Outcome nlp = run({"design", task(servo, ""), "--solver", "ipopt", "--no-baselines"});
  EXPECT_EQ(nlp.code, 0) << nlp.err;
}

/// The settings of a control for an axis as it is: proved, accepted by verify, and slower than without the servo.
TEST_F(ResponseOfTasks, SettingsOfAControlConsiderIt) {
  const std::string family = "[design]\nfamily = \"averages\"\nstages = 2\n";
  const std::string mode = "[[mode]]\nfrequency_Hz = 40\nresidual_max = 0.2\n";
  std::map<std::string, double> times;
  for (const auto& [name, text] :
       {std::pair("none", task("", family, "none.toml")), std::pair("mode", task(servo, family + mode, "mode.toml")),
        std::pair("servo", task(servo, family, "servo.toml")),
        std::pair("both", task(servo, family + smoothing, "both.toml")),
        std::pair("dry", task("mass_kg = 50\nforce_max_N = 250\ncoulomb_N = 40\n", family, "dry.toml"))}) {
    SCOPED_TRACE(name);
    const std::string result = folder_.path("r.json");
    const Outcome outcome = run({"design", text, "--json", result});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_TRUE(outcome.out.starts_with("Set these: ")) << outcome.out;
    EXPECT_THAT(outcome.out, HasSubstr("proved best for this family"));
    times[name] = Json::parse(folder_.read("r.json"))["cycle_time_s"];
    const Outcome verified = run({"verify", result});
    EXPECT_EQ(verified.code, 0) << verified.out << verified.err;
    EXPECT_THAT(verified.out, HasSubstr("proof accepted"));
  }
  EXPECT_GT(times["servo"], times["none"]);
  EXPECT_GE(times["both"], times["servo"]);
}

}  // namespace
}  // namespace accdec
