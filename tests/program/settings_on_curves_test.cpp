#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <accdec/filter.hpp>
#include <accdec/plan/filters/effort.hpp>
#include <accdec/plan/filters/pairwise_times.hpp>
#include <accdec/plan/filters/program_settings.hpp>
#include <accdec/program.hpp>
#include <accdec/simulate.hpp>

#include "program_command.hpp"

// Settings of a control for programs whose curves need delays or lower feeds.

namespace accdec {
namespace {

using test::ProgramCommand;
using testing::HasSubstr;

/// Lower feeds on the arcs take less time than delays inside them. A setting that needs them is not passed over: each
/// is planned alone, too.
TEST_F(ProgramCommand, NoSettingIsPassedOverForDelaysThatLowerFeedsSave) {
  for (const auto& [feed, tolerance] : {std::pair(3000, 0.0003), {4000, 0.001}}) {
    write("part.ngc",
          fmt::format("G21 G90 G64 P{} F{}\nG1 X10\nG3 X10 Y4 J2\nG1 X0\nG3 X0 Y8 J2\nG1 X10\nM2\n", tolerance, feed));
    const auto time = [&](const std::string& lengths) {
      write("t.toml",
            "sample_period_ms = 1\n[controller]\ndelays = [\"continuous\", \"exact-stop\"]\n[design]\n"
            "family = \"averages\"\nstages = 1\n" +
                lengths + "\n[[axis]]\nacceleration_max_mm_s2 = 6000\n");
      EXPECT_EQ(run("program part.ngc --task t.toml --feeds keep --json r.json").code, 0) << read("err");
      return nlohmann::json::parse(read("r.json"))["cycle_time_s"].get<double>();
    };
    const double best = time("length_max_ms = 30");
    EXPECT_THAT(read("out"), HasSubstr("no other of 29 settings is planned faster"));
    for (int length = 5; length <= 10; ++length)
      EXPECT_LE(best, time(fmt::format("length_set_ms = [{}]", length)) * (1.0 + 1e-9)) << length;
  }
}

/// A leg of more joints than are looked at keeps its feeds.
TEST_F(ProgramCommand, VeryManyJointsOfALegKeepTheirFeeds) {
  std::string part = "G21 G90 G64 P0.002 F6000\n";
  for (int i = 1; i <= 300'100; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / 100, radius = 5 + 1e-5 * i;
    part += fmt::format("G1 X{:.5f} Y{:.5f}\n", radius * std::cos(angle), radius * std::sin(angle));
  }
  write("part.ngc", part + "M2\n");
  write("t.toml", "sample_period_ms = 1\n[[axis]]\nacceleration_max_mm_s2 = 6000\n");
  const Task task = read_task(folder_.path("t.toml"), {.require_corners = false, .axes = 9});
  const Toolpath path = read_program_file(folder_.path("part.ngc"), task, {}, {}).path;
  const Machine machine = program_machine(task.machine, path);
  const Filter filter = Filter(std::vector<double>(20, 0.05));
  Effort effort;
  EXPECT_EQ(lost_on_curves(path, filter, task.sample_period, machine, effort), unlimited);
  const PairwiseTimes kept(path, filter, task.sample_period, machine, effort, false, false);
  const PairwiseTimes slowed(path, filter, task.sample_period, machine, effort, false, true);
  EXPECT_TRUE(kept.curves_delayed());
  EXPECT_EQ(slowed.any(), kept.any());
}

/// Half of the way between two deviations has the mean of their values; one further away is found by itself.
TEST(KnownBySpread, InterpolatesBetweenNearDeviations) {
  KnownBySpread known;
  int found = 0;
  const auto of = [&](double value) { return [&found, value] { return ++found, value; }; };
  EXPECT_EQ(known.at(16.0, of(3.0)), 3.0);
  EXPECT_EQ(known.at(17.5, of(5.0)), 5.0);
  EXPECT_EQ(known.at(16.75, of(0.0)), 4.0);
  EXPECT_EQ(known.at(17.5, of(0.0)), 5.0);
  EXPECT_EQ(known.at(20.0, of(9.0)), 9.0);
  EXPECT_EQ(known.least(15.0), 0.0);
  EXPECT_EQ(known.least(19.0), 5.0);
  EXPECT_EQ(known.at(18.5, of(8.0)), 8.0);  // 17.5 and 20 are further apart than 10 %
  EXPECT_EQ(found, 4);
}

TEST(ProgramAnswer, SaysHowManyStopsAreInsideArcs) {
  ProgramResult result;
  result.cycle_time = 10.0;
  result.plan.path.inside_arc = {0, 1, 1, 0, 0};
  ProgramSettings& settings = result.settings.emplace();
  settings.chosen = {.family = SettingFamily::averages, .values = {{"", 9.0, "ms"}}};
  settings.chosen.delays = {DelayKind::exact_stop, DelayKind::exact_stop, DelayKind::continuous, DelayKind::exact_stop,
                            DelayKind::continuous};
  EXPECT_THAT(program_settings_answer(result), HasSubstr("; exact-stop at 3 joints, 1 of them inside arcs. 10 s for"));
  result.plan.path.inside_arc.assign(5, 0);
  EXPECT_THAT(program_settings_answer(result), HasSubstr("; exact-stop at 3 joints. 10 s for"));
}

}  // namespace
}  // namespace accdec
