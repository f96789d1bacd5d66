#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <random>
#include <regex>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <accdec/filter.hpp>
#include <accdec/plan/command/choose_feeds.hpp>
#include <accdec/plan/delays/control_delays.hpp>
#include <accdec/plan/run/fixed_plan.hpp>
#include <accdec/simulate/direct.hpp>

#include "corner_program.hpp"
#include "program_command.hpp"
#include "reference.hpp"

// Corners of programs that a control passes at a part of the feed.

namespace accdec {
namespace {

using test::Output;
using test::ProgramCommand;
using testing::HasSubstr;

/// mm/min, of a block of the plan.
double feed_of(const Toolpath& path, std::size_t b) {
  return 6e4 * std::hypot(path.point(b + 1)[0] - path.point(b)[0], path.point(b + 1)[1] - path.point(b)[1]) /
         path.duration[b];
}

/// Both parts of the programmed feeds at a corner: one multiple of the step, or the whole.
void expect_steps(const Toolpath& path, std::size_t b, double before, double behind, double step,
                  const std::string& what) {
  const double in = feed_of(path, b) / before, out = feed_of(path, b + 1) / behind;
  EXPECT_NEAR(in, out, 1e-6) << what;
  if (in > 1.0 - 1e-6) return;
  EXPECT_NEAR(in / step, std::round(in / step), 1e-5) << what;
  EXPECT_GE(in, step * (1.0 - 1e-6)) << what;
}

/// One corner between long legs: the largest multiple whose error, by the definition of the model, is within the
/// tolerance and whose step of velocity the acceleration allows. Both grow with the feed.
TEST(ProgramCornerFeeds, ACornerBetweenLongLegsIsPassedAtTheLargestMultiple) {
  const Task task = test::averages_task(1, {DelayKind::corner_feed});
  struct Case {
    double before, behind, tolerance;  // mm/min, mm
    int taps;
    double step;
  };
  for (const Case& c : {Case{6000, 3000, 0.05, 20, 0.05},
                        {3000, 6000, 0.05, 20, 0.07},
                        {3000, 3000, 0.02, 20, 0.1},
                        {6000, 6000, 0.5, 12, 0.05},
                        {5000, 4000, 0.4, 16, 0.15},
                        {900, 1100, 0.1, 14, 0.05}}) {
    Toolpath path = test::path_of(
        fmt::format("G21 G90 G64 P{}\nG1 X60 F{}\nY60 F{}\nM2\n", c.tolerance, c.before, c.behind), task.machine);
    path.control = {{DelayKind::corner_feed, DelayKind::continuous}, 0.0};
    const ScheduledPlan plan =
        schedule_feeds(path, boxcar(c.taps - 1), 1e-3, program_machine(task.machine, path), 40, {}, c.step);
    ASSERT_TRUE(all_holds(plan.plan));
    // With taps 1/n, p(k) = sum_{i > k} (i - k)/n and q(k) = sum_{i < k} (k - i)/n; mm.
    double error = 1e9;
    for (int k = 0; k <= c.taps; ++k) {
      double p = 0.0, q = 0.0;
      for (int i = 0; i < c.taps; ++i) p += std::max(i - k, 0), q += std::max(k - i, 0);
      error = std::min(error, std::hypot(c.before / 6e4 * p / c.taps, c.behind / 6e4 * q / c.taps));
    }
    // The largest change of an axis in one sample is that of a step over the taps; mm/s^2.
    const double acceleration = std::max(c.before, c.behind) / 60.0 / c.taps / 1e-3;
    int multiple = 1;
    while ((multiple + 1) * c.step < 1.0 - 1e-9 && (multiple + 1) * c.step * error <= c.tolerance &&
           (multiple + 1) * c.step * acceleration <= 6000.0)
      ++multiple;
    const bool whole = error <= c.tolerance && acceleration <= 6000.0;
    const double part = whole ? 1.0 : multiple * c.step;
    const auto at = static_cast<std::size_t>(std::find(plan.path.joint.begin(), plan.path.joint.end(), Joint::corner) -
                                             plan.path.joint.begin());
    ASSERT_LT(at + 1, plan.path.blocks());
    EXPECT_EQ(plan.plan.delays[at], 0);
    EXPECT_NEAR(feed_of(plan.path, at) / c.before, part, 1e-6) << c.before << " " << c.behind;
    EXPECT_NEAR(feed_of(plan.path, at + 1) / c.behind, part, 1e-6) << c.before << " " << c.behind;
  }
}

/// If short blocks leave no room to reach a multiple, the corner has the one below it. Each corner that is passed
/// without a delay is looked at.
TEST(ProgramCornerFeeds, EveryCornerOfRandomProgramsIsPassedAtAMultiple) {
  const Task task = test::averages_task(1, {DelayKind::corner_feed});
  int held = 0, seen = 0, short_blocks = 0;
  for (unsigned seed = 0; seed < 40; ++seed) {
    std::mt19937 random(seed);
    const auto draw = [&](double low, double high) {
      return std::uniform_real_distribution<double>(low, high)(random);
    };
    std::string text = "G21 G90 G64 P0.05\n";
    std::map<std::uint32_t, double> feed;  // of each line; 0: rapid
    double x = 0.0, y = 0.0, heading = 0.0;
    for (std::uint32_t line = 2; line < 14; ++line) {
      const double length = draw(0.0, 1.0) < 0.4 ? draw(0.2, 1.5) : draw(2.0, 30.0);
      heading += draw(0.5, 2.6) * (draw(0.0, 1.0) < 0.5 ? 1.0 : -1.0);
      x += length * std::cos(heading), y += length * std::sin(heading);
      feed[line] = draw(0.0, 1.0) < 0.1 ? 0.0 : std::round(draw(800.0, 7000.0));
      const std::string word = feed[line] > 0.0 ? fmt::format("G1 F{}", feed[line]) : "G0";
      text += fmt::format("{} X{:.4f} Y{:.4f}\n", word, x, y);
      short_blocks += length < 1.5 ? 1 : 0;
    }
    Toolpath path = test::path_of(text + "M2\n", task.machine);
    const double step = seed % 3 == 0 ? 0.05 : seed % 3 == 1 ? 0.12 : 0.2;
    const bool stops = seed % 2 == 0;
    path.control = {{DelayKind::corner_feed, stops ? DelayKind::exact_stop : DelayKind::continuous}, 0.0};
    if (stops) path.control.kinds.push_back(DelayKind::continuous);
    const Filter filter = averages(std::vector<int>{12, 6});
    const ScheduledPlan plan = schedule_feeds(path, filter, 1e-3, program_machine(task.machine, path), 40, {}, step);
    // A control that only lowers feeds may have no multiple that is slow enough.
    if (!all_holds(plan.plan) || !corner_feeds_had(plan.path, path, plan.plan.delays, step)) continue;
    ++held;
    for (std::size_t b = 0; b + 1 < plan.path.blocks(); ++b) {
      if (plan.path.joint[b] != Joint::corner || plan.plan.delays[b] > 0) continue;
      ++seen;
      double before = feed[plan.path.line[b]], behind = feed[plan.path.line[b + 1]];
      if (before == 0.0 && behind == 0.0) continue;
      if (before == 0.0) before = behind;  // a rapid move beside a feed move is as fast as that
      if (behind == 0.0) behind = before;
      expect_steps(plan.path, b, before, behind, step, fmt::format("seed {}, line {}", seed, plan.path.line[b]));
    }
  }
  EXPECT_GE(held, 34);
  EXPECT_GE(seen, 200);
  EXPECT_GE(short_blocks, 100);
}

/// A control that only lowers feeds: no joint is delayed, and the motion, made directly, holds every tolerance.
TEST(ProgramCornerFeeds, CornerFeedsHoldTolerancesWithoutDelays) {
  const Task task = test::averages_task(1, {DelayKind::corner_feed});
  const TemporaryFolder folder;
  const std::string program = folder.write("part.ngc", test::corner_program);
  ProgramFileOptions options;
  ProgramFile file = read_program_file(program, task, options, {});
  const ProgramResult result = run_fixed_plan(file, task, options, {});
  ASSERT_TRUE(result.verification.feasible) << result.message;
  ASSERT_TRUE(result.settings);
  const Toolpath& path = result.plan.path;
  const FilteredCommand& command = *result.plan.command();
  const DirectMotion motion = direct_motion(path, task.sample_period, command.delays, {{command.filter}, {}});
  int slowed = 0, whole = 0;
  for (std::size_t b = 0; b + 1 < path.blocks(); ++b) {
    if (path.joint[b] != Joint::corner) continue;
    EXPECT_EQ(command.delays[b], 0) << "line " << path.line[b];
    EXPECT_LE(direct_error(motion, path, b), 50e-6 * (1.0 + 1e-9)) << "line " << path.line[b];
    const DelayKind kind = result.settings->chosen.delays[b];
    if (kind == DelayKind::corner_feed)
      expect_steps(path, b, 3000.0, 3000.0, 0.05, fmt::format("line {}", path.line[b]));
    slowed += kind == DelayKind::corner_feed ? 1 : 0, whole += kind == DelayKind::continuous ? 1 : 0;
  }
  EXPECT_GE(slowed, 4);
  EXPECT_EQ(slowed + whole, 7);
}

/// A record that calls all its corner feeds continuous, of which an answer says nothing.
std::string without_corner_feeds(const std::string& text) {
  nlohmann::ordered_json record = nlohmann::ordered_json::parse(text);
  nlohmann::ordered_json& kinds = record["settings"]["delays"];
  std::replace(kinds.begin(), kinds.end(), nlohmann::ordered_json("corner-feed"), nlohmann::ordered_json("continuous"));
  std::string answer = record["settings"]["answer"];
  const std::size_t at = answer.find("; corner-feed at "), end = answer.find(" joints", at) + 7;
  record["settings"]["answer"] = answer.erase(at, end - at);
  return record.dump();
}

TEST_F(ProgramCommand, CornerFeedsAreFeedWordsThatAreVerified) {
  write("control.toml", std::string(test::corner_machine) +
                            "[design]\nfamily = \"averages\"\n[controller]\ndelays = \"corner-feed\"\n");
  write("part.ngc", test::corner_program);
  ASSERT_EQ(run("program part.ngc --task control.toml --time-limit 4 --json r.json --emit e.ngc").code, 0)
      << read("err");
  EXPECT_THAT(read("out"), ::testing::ContainsRegex("Set these: .*; corner-feed at [0-9]+ joints"));
  EXPECT_EQ(read("e.ngc").find("\nG4 "), std::string::npos) << "the control has no dwells";
  EXPECT_EQ(run("verify r.json").code, 0) << read("out");
  nlohmann::ordered_json record = nlohmann::ordered_json::parse(read("r.json"));
  // As many joints of each kind, but not these.
  nlohmann::ordered_json& kinds = record["settings"]["delays"];
  std::swap(*std::find(kinds.begin(), kinds.end(), "corner-feed"),
            *std::find(kinds.begin(), kinds.end(), "continuous"));
  write("forged.json", record.dump());
  const Output forged = run("verify forged.json");
  EXPECT_EQ(forged.code, 1) << forged.err;
  EXPECT_THAT(forged.out, HasSubstr("names corner-feed where the control runs on"));
  // A lower feed is none that the control keeps.
  write("renamed.json", without_corner_feeds(read("r.json")));
  const Output renamed = run("verify renamed.json");
  EXPECT_EQ(renamed.code, 1) << renamed.err;
  EXPECT_THAT(renamed.out, HasSubstr("a corner at a lower feed is a corner-feed, not continuous"));
}

/// The feeds written and recorded are those of the task's step: with another one the record is rejected.
TEST_F(ProgramCommand, CornerFeedsThatAreNoMultipleAreRejected) {
  write("control.toml", std::string(test::corner_machine) +
                            "[design]\nfamily = \"averages\"\nstages = 1\norder_max = 30\n"
                            "[controller]\ndelays = \"corner-feed\"\ncorner_feed_step = 0.125\n");
  write("part.ngc", test::corner_program);
  ASSERT_EQ(run("program part.ngc --task control.toml --time-limit 4 --json r.json --emit e.ngc").code, 0)
      << read("err");
  EXPECT_EQ(run("verify r.json").code, 0) << read("out");
  // 3000 mm/min times 0.125 is 375.
  const nlohmann::json record = nlohmann::json::parse(read("r.json"));
  int at_corners = 0;
  std::vector<double> feeds;
  const std::string emitted = read("e.ngc");
  const std::regex word(" F([0-9.]+)");
  for (std::sregex_iterator at(emitted.begin(), emitted.end(), word), end; at != end; ++at)
    feeds.push_back(std::stod((*at)[1]));
  for (const double feed : feeds) at_corners += std::abs(feed / 375.0 - std::round(feed / 375.0)) < 1e-4 ? 1 : 0;
  const auto& kinds = record["settings"]["delays"];
  const auto corner_feeds = std::count(kinds.begin(), kinds.end(), "corner-feed");
  EXPECT_GE(corner_feeds, 4);
  EXPECT_GE(at_corners, corner_feeds);
  std::string text = read("r.json");
  const std::size_t step = text.find("corner_feed_step = 0.125");
  ASSERT_NE(step, std::string::npos);
  write("forged.json", text.replace(step, 24, "corner_feed_step = 0.137"));
  std::string task = read("control.toml");
  write("control.toml", task.replace(task.find("0.125"), 5, "0.137"));
  const Output forged = run("verify forged.json");
  EXPECT_EQ(forged.code, 1) << forged.err;
  EXPECT_THAT(forged.out, HasSubstr("not one multiple of corner_feed_step = 0.137"));
  write("renamed.json", without_corner_feeds(read("forged.json")));
  EXPECT_THAT(run("verify renamed.json").out, HasSubstr("not one multiple of corner_feed_step = 0.137"));
}

/// Exact stops need no G4, and the axes come to rest at them.
TEST_F(ProgramCommand, ExactStopsAreWrittenWithoutANoteOnDwells) {
  const std::string head = std::string(test::corner_machine) + "[design]\nfamily = \"averages\"\n[controller]\n";
  write("part.ngc", test::corner_program);
  for (const auto& [kind, note] : {std::pair("exact-stop", false), std::pair("dwell", true)}) {
    write("control.toml", head + "delays = [\"" + kind + "\"]\n");
    ASSERT_EQ(run("program part.ngc --feeds keep --task control.toml --time-limit 4 --emit e.ngc").code, 0)
        << read("err");
    const std::string text = read("e.ngc");
    EXPECT_EQ(text.find("\nG4 P") != std::string::npos, note) << kind;
    EXPECT_EQ(text.find("the axes need not come to rest") != std::string::npos, note) << kind;
  }
}

TEST_F(ProgramCommand, AMeasuredInPositionIsRefusedWhereItStands) {
  write("part.ngc", test::corner_program);
  write("control.toml",
        "sample_period_ms = 1.0\n[design]\nfamily = \"averages\"\n[controller]\n"
        "delays = [\"in-position\"]\nin_position_of = \"actual\"\n[[axis]]\nservo_gain_1_s = 100\n"
        "acceleration_max_mm_s2 = 6000\n[program]\nerror_max_um = 50\n");
  const Output refused = run("program part.ngc --task control.toml --time-limit 2");
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.err, HasSubstr("control.toml:6:1: a program does not consider [controller] `in_position_of`"));
}

/// A control that only lowers feeds has nothing that --feeds keep could use.
TEST_F(ProgramCommand, CornerFeedsAloneAreRefusedWhereFeedsAreKept) {
  const std::string head = std::string(test::corner_machine) + "[design]\nfamily = \"averages\"\n[controller]\n";
  write("part.ngc", test::corner_program);
  write("control.toml", head + "corner_feed_step = 0.1\ndelays = [\"corner-feed\"]\n");
  const Output refused = run("program part.ngc --feeds keep --task control.toml --json k.json --emit k.ngc");
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.err, HasSubstr("control.toml:12:10: `delays` = \"corner-feed\""));
  EXPECT_THAT(refused.err, HasSubstr("allowed are --feeds choose, or another kind beside it: continuous, exact-stop"));
  EXPECT_FALSE(std::filesystem::exists(folder_.path("k.json")));
  EXPECT_FALSE(std::filesystem::exists(folder_.path("k.ngc")));
  // With a kind that runs on it depends on the program.
  write("control.toml", std::string(test::corner_machine) +
                            "[design]\nfamily = \"averages\"\nstages = 1\norder_max = 20\n[controller]\n"
                            "delays = [\"corner-feed\", \"continuous\"]\n");
  const Output none = run("program part.ngc --feeds keep --task control.toml --time-limit 4 --json k.json");
  EXPECT_EQ(none.code, 1);
  EXPECT_THAT(none.err, HasSubstr("control.toml:13:10: no setting of"));
  EXPECT_THAT(none.err, HasSubstr("use --feeds choose, or name a kind that waits: exact-stop"));
  write("straight.ngc", "G21 G90 G64 P0.05\nG1 X30 F3000\nX60\nM2\n");
  EXPECT_EQ(run("program straight.ngc --feeds keep --task control.toml --time-limit 4").code, 0) << read("err");
}

/// Nothing but a stop passes a corner under G61.
TEST_F(ProgramCommand, CornersUnderG61AreRefusedAtOnceForAControlThatRunsOn) {
  write("g61.ngc", "G21 G90 G61 F2000\nG1 X5\nG1 Y5\nM2\n");
  for (const char* delays : {"\"continuous\"", "\"corner-feed\""}) {
    write("control.toml",
          std::string(test::corner_machine) + "[design]\nfamily = \"averages\"\n[controller]\ndelays = " + delays);
    const Output refused = run("program g61.ngc --task control.toml --json k.json");
    EXPECT_EQ(refused.code, 1);
    EXPECT_THAT(refused.err, HasSubstr("control.toml:11:10: line 2 ends in a corner under G61"));
    EXPECT_FALSE(std::filesystem::exists(folder_.path("k.json")));
  }
}

}  // namespace
}  // namespace accdec
