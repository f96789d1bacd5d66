#include "support/program_result.hpp"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

// Results of `accdec program` given to verify, plot and export.

namespace accdec {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

TEST_F(ProgramResult, IsVerifiedFromItsOwnCommands) {
  for (const std::vector<std::string>& options :
       std::vector<std::vector<std::string>>{{}, {"--feeds", "keep"}, {"--plan", "profiles"}, {"--rapid-stops"}}) {
    SCOPED_TRACE(::testing::PrintToString(options));
    const Outcome planned = plan(options);
    ASSERT_EQ(planned.code, 0) << planned.err;
    const Outcome checked = verify();
    EXPECT_EQ(checked.code, 0) << checked.out << checked.err;
    EXPECT_THAT(checked.out, StartsWith("accepted: "));
    EXPECT_THAT(checked.out, HasSubstr("read again: the plan passes its points in order"));
  }
}

TEST_F(ProgramResult, ForgedClaimsAreRejected) {
  ASSERT_EQ(plan({"--feeds", "keep"}).code, 0);
  const Json good = json();
  const auto rejected = [&](const char* what, Json bad, const char* reason) {
    const Outcome outcome = changed(bad);
    EXPECT_EQ(outcome.code, 1) << what << ": " << outcome.out;
    EXPECT_THAT(outcome.out, HasSubstr(reason)) << what;
  };
  Json bad = good;
  bad["cycle_time_s"] = good["cycle_time_s"].get<double>() - 0.001;
  rejected("a shorter time", bad, "cycle_time_s is recorded as");
  bad = good;
  bad["commands"]["delay_samples"][0] = bad["commands"]["delay_samples"][0].get<int>() + 0.5;
  EXPECT_EQ(changed(bad).code, 2) << "half a sample";
  bad = good;
  for (Json& delay : bad["commands"]["delay_samples"]) delay = 0;
  rejected("no delays", bad, "exceeds its tolerance");
  bad = good;
  for (Json& duration : bad["commands"]["duration_s"]) duration = 0.5 * duration.get<double>();
  rejected("twice the feed", bad, "above its programmed feed");
  bad = good;
  for (Json& tolerance : bad["commands"]["tolerance_m"]) tolerance = 1.0;
  rejected("wider tolerances", bad, "tolerance is wider");
  bad = good;
  bad["commands"]["points_m"][2] = good["commands"]["points_m"][2].get<double>() - 0.001;
  rejected("another path", bad, "the commands stop inside it");
  bad = good;
  bad["limits"][1]["utilisation"] = 0.1;
  rejected("a limit used less", bad, "utilisation is recorded as");
  bad = good;
  bad["limits"].erase(1);
  rejected("a limit left out", bad, "limits[1] should be");
  bad = good;
  bad["commands"]["dwell"] = Json::array();
  rejected("no dwell", bad, "its dwell is not kept");
  bad = good;
  bad["inputs"]["interpreted"] = true;
  rejected("no reading again", bad, "accdec reads the program itself");
  bad = good;
  bad["program"] = "other.ngc";
  rejected("another program's name", bad, "program is recorded as other.ngc");
}

TEST_F(ProgramResult, CountsAreRightAndWhatIsNotComparedIsOfItsKind) {
  for (const char* feeds : {"keep", "choose"}) {
    ASSERT_EQ(plan({"--feeds", feeds}).code, 0);
    const Json good = json();
    const auto rejected = [&](const char* pointer, const Json& value) {
      Json bad = good;
      bad[Json::json_pointer(pointer)] = value;
      const Outcome outcome = changed(bad);
      EXPECT_EQ(outcome.code, 1) << pointer << " = " << value << ": " << outcome.out;
      std::string name = std::string(pointer).substr(1);
      std::replace(name.begin(), name.end(), '/', '.');
      EXPECT_THAT(outcome.out, HasSubstr(name + " is recorded as ")) << value;
    };
    const Json raised = good["corners"]["raised_by_overlap"];
    for (const Json& value : {Json(raised.get<int>() + 1), Json(-1), Json("2"), Json(0.5), Json(), Json::array({1})})
      rejected("/corners/raised_by_overlap", value);
    for (const Json& value : {Json(-1), Json("2"), Json(0.5), Json()}) rejected("/corners/slowed_blocks", value);
    for (const Json& value : {Json(-1.0), Json("2"), Json()}) rejected("/cycle_time_exact_stop_s", value);
    for (const Json& value : {Json(1), Json(Json::array({1})), Json(Json::array({Json::object()}))})
      rejected("/feeds_slowed", value);
    rejected("/solver", Json::object());
    rejected("/exact_stop_breaks", 1);
    // Bounds are not above the plan, and those beside the list are the same.
    for (std::size_t i = 0; i < good["bounds"].size(); ++i) {
      Json bad = good;
      for (const double time : {1e308, 0.5 * good["bounds"][i]["time_s"].get<double>()}) {
        bad["bounds"][i]["time_s"] = time;
        const bool lower = good["bounds"][i]["name"] == "any motion" && time < 1e308;  // is a bound, too
        EXPECT_EQ(changed(bad).code, lower ? 0 : 1) << bad["bounds"][i];
      }
      bad = good;
      bad["bounds"][i]["name"] = "every motion";
      EXPECT_EQ(changed(bad).code, 1);
    }
    // The plan at the programmed feeds is not shorter than their way, and not longer than any plan could be.
    if (good.contains("cycle_time_kept_feeds_s")) {
      for (const double time : {1e308, 1e4 * good["cycle_time_s"].get<double>(), 1e-3})
        rejected("/cycle_time_kept_feeds_s", time);
    }
    EXPECT_EQ(good.contains("cycle_time_kept_feeds_s"), feeds == std::string("choose"));
    Json added = good;
    added["cycle_time_kept_feeds_s"] = good["cycle_time_s"];
    if (feeds == std::string("keep")) {
      EXPECT_EQ(changed(added).code, 1);
    }
    // Times of other plans and counts of bounds that contradict the plan.
    for (const double time : {1e308, 0.1}) {
      rejected("/cycle_time_exact_stop_s", time);
      if (time > 1.0) rejected("/cycle_time_no_delay_s", time);
    }
    const auto corners = good["corner_bound"]["corners"].get<int>();
    rejected("/corner_bound/counted", corners + 1);
    rejected("/corner_bound/classes", 1'000'000);
  }
}

// A verified plan that is faster would have been the answer; and texts follow from the plan and its bounds.
TEST_F(ProgramResult, PlansBesideItAndTextsAreNotForged) {
  ASSERT_EQ(plan({"--plan", "profiles"}).code, 0);
  const Json good = json();
  ASSERT_EQ(verify().code, 0) << verify().out;
  const auto rejected = [&](const Json& bad, const std::string& reason) {
    const Outcome outcome = changed(bad);
    EXPECT_EQ(outcome.code, 1) << reason;
    EXPECT_THAT(outcome.out, HasSubstr(reason));
  };
  ASSERT_EQ(good["candidates"].size(), 1U);
  Json bad = good;
  bad["candidates"][0]["verified"] = true;
  bad["candidates"][0]["cycle_time_s"] = 0.99 * good["cycle_time_s"].get<double>();
  rejected(bad, "is recorded as verified with");
  bad = good;
  bad["candidates"][0]["plan"] = "quick";
  rejected(bad, "candidates: no plan is called \"quick\"");
  for (const char* always : {"control_must", "not_considered", "bounds", "feeds_slowed", "solver"}) {
    bad = good;
    bad.erase(always);
    rejected(bad, std::string(always) + " is missing");
  }
  for (std::size_t i = 0; i < good["bounds"].size(); ++i) {
    bad = good;
    bad["bounds"][i]["motions"] = "";
    rejected(bad, "bounds[" + std::to_string(i) + "].motions is recorded as");
    bad = good;
    bad["bounds"].erase(i);
    EXPECT_EQ(changed(bad).code, good["bounds"][i]["name"] == "any motion" ? 0 : 1) << i;
  }
}

// The motion does not depend on the feed of a leg with steady ramps, nor on how a corner at rest would be stretched.
TEST_F(ProgramResult, NumbersWithoutUseAreNamedAsNotChecked) {
  ASSERT_EQ(plan({"--plan", "profiles"}).code, 0);
  if (!json()["commands"]["trajectory"].contains("levels")) GTEST_SKIP() << "another plan is the fastest";
  EXPECT_EQ(json()["commands"]["trajectory"]["levels"], 1);
  const std::string said = verify().out;
  EXPECT_THAT(said, HasSubstr("commands.trajectory.feed_m_s"));
  EXPECT_THAT(said, HasSubstr("commands.trajectory.stretch_s2_m at rest"));
}

// Chords of arcs may have been read again, finer; without arcs the corners of the bound are those of the program.
TEST_F(ProgramResult, CornersOfTheBoundAreThoseOfTheProgram) {
  folder_.write("part.ngc", "G21 G90 G64 P0.02\nF6000\nG1 X30 Y0\nX30 Y20\nX0 Y0\nM2\n");
  ASSERT_EQ(plan().code, 0);
  Json bad = json();
  EXPECT_EQ(bad["corner_bound"]["corners"], 2);
  bad["corner_bound"]["corners"] = 3;
  const Outcome outcome = changed(bad);
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.out, HasSubstr("corner_bound.corners is recorded as 3, found 2"));
}

TEST_F(ProgramResult, OnlyFeasibleAndFailedAreStatusesOfPrograms) {
  ASSERT_EQ(plan().code, 0);
  Json bad = json();
  bad["status"] = "optimal";
  const Outcome outcome = changed(bad);
  EXPECT_EQ(outcome.code, 2) << outcome.out;
  EXPECT_THAT(outcome.err, HasSubstr("status: \"optimal\" is unknown; allowed are feasible, failed"));
}

TEST_F(ProgramResult, SaysWhatItLeavesOut) {
  ASSERT_EQ(plan().code, 0);
  EXPECT_EQ(json()["not_considered"], Json::array({"vibration", "servo"}));
}

// All that verify does not say it leaves out is compared: each value of the summary is forged, one at a time.
TEST_F(ProgramResult, NoValueOfTheSummaryCanBeForged) {
  ASSERT_EQ(plan({"--plan", "fixed", "--filter-bound"}).code, 0);
  const Json good = json();
  const Outcome checked = verify();
  ASSERT_EQ(checked.code, 0) << checked.out;
  EXPECT_THAT(checked.out, HasSubstr("not checked, because they say how the plan was found"));
  std::vector<Json::json_pointer> all;
  for (const auto& [name, value] : good.items()) {
    if (name != "inputs" && name != "commands") leaves(value, Json::json_pointer("/" + name), all);
  }
  std::size_t looked_at = 0;
  for (const Json::json_pointer& at : all) {
    std::string member = at.to_string().substr(1);
    std::replace(member.begin(), member.end(), '/', '.');
    if (checked.out.find(member.starts_with("corners.") ? member : member.substr(0, member.find('.'))) !=
        std::string::npos)
      continue;                                                                     // said not to be checked
    if (at.to_string().starts_with("/filter/taps/") && at.back() != "3") continue;  // one stands for all
    Json bad = good;
    bad[at] = forged(good[at]);
    EXPECT_NE(changed(bad).code, 0) << at.to_string() << " as " << bad[at].dump();
    ++looked_at;
  }
  EXPECT_GT(looked_at, 60U);
  Json more = good;
  more["surprise"] = 1;
  EXPECT_EQ(changed(more).code, 1);
  more = good;
  more.erase("worst_corners");
  EXPECT_NE(changed(more).code, 0);
}

TEST_F(ProgramResult, OfAnotherProgramOrTaskItIsRejected) {
  ASSERT_EQ(plan().code, 0);
  const std::string program = folder_.read("part.ngc"), task = folder_.read("mill.toml");
  folder_.write("part.ngc", "G21 G90 G64 P1\nF6000\nG1 X30 Y0\nM2\n");
  EXPECT_EQ(verify().code, 1);
  EXPECT_THAT(verify().out, HasSubstr("part.ngc has changed since"));
  folder_.write("part.ngc", program);
  folder_.write("mill.toml", task + "\n# other\n");
  EXPECT_EQ(verify().code, 1);
  EXPECT_THAT(verify().out, HasSubstr("mill.toml has changed since"));
  // The task is in the result, the program is not.
  std::filesystem::remove(task_);
  EXPECT_EQ(verify().code, 0);
  EXPECT_THAT(verify().out, HasSubstr("the task is the one in the result"));
  std::filesystem::remove(program_);
  EXPECT_EQ(verify().code, 1);
  EXPECT_THAT(verify().err, HasSubstr("part.ngc is not there"));
}

TEST_F(ProgramResult, KeysStandOnce) {
  ASSERT_EQ(plan().code, 0);
  std::string text = folder_.read("result.json");
  text.replace(text.find("\"status\""), 0, "\"status\": \"failed\", ");
  folder_.write("result.json", text);
  const Outcome outcome = verify();
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("stands twice"));
}

TEST_F(ProgramResult, WithoutCommandsItIsNotAccepted) {
  ASSERT_EQ(plan().code, 0);
  Json without = json();
  without["commands"] = nullptr;
  const Outcome outcome = changed(without);
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("not checked: the result holds no commands"));
  // Damaged ones are bad input.
  ASSERT_EQ(plan().code, 0);
  Json damaged = json();
  damaged["commands"]["delay_samples"].erase(0);
  EXPECT_EQ(changed(damaged).code, 2);
  damaged = json();
  damaged["commands"]["duration_s"][0] = -1;
  EXPECT_EQ(changed(damaged).code, 2);
}

TEST_F(ProgramResult, SamplesBehindALongDwellAreCounted) {
  // 110000 s of 0.05 ms each: more samples than 32 bits count.
  folder_.write("mill.toml",
                "sample_period_ms = 0.05\n[filter]\nkind = \"boxcar\"\norder = 40\n[[axis]]\n"
                "acceleration_max_mm_s2 = 6000\njerk_max_mm_s3 = 500000\n");
  folder_.write("part.ngc", "G21 G90 F600\nG1 X10\nG4 P110000\nG1 F900 X20\nM2\n");
  ASSERT_EQ(plan().code, 0);
  EXPECT_GT(json()["limits"][0]["sample"].get<double>(), 2.2e9);
  EXPECT_EQ(verify().code, 0);
}

TEST_F(ProgramResult, CostsAreEstimatedFirst) {
  ASSERT_EQ(plan().code, 0);
  Json absurd = json();
  absurd["commands"]["duration_s"][0] = 2e6;
  const Outcome outcome = changed(absurd);
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("would take about"));
}

// The estimate is of simulating alone, a few samples a move. Reading 20 000 moves takes longer than it.
TEST_F(ProgramResult, TheTimeLimitEndsAnyCheck) {
  folder_.write("mill.toml",
                "sample_period_ms = 1\n[filter]\nkind = \"boxcar\"\norder = 1\n[[axis]]\n"
                "velocity_max_mm_s = 500\n");
  std::string text = "G21 G90 G64 P1 F6000\n";
  for (int i = 1; i <= 20'000; ++i) text += fmt::format("G1 X{:.1f} Y{}\n", 0.1 * i, i % 2);
  folder_.write("part.ngc", text + "M2\n");
  ASSERT_EQ(plan({"--feeds", "keep"}).code, 0);
  const Outcome outcome = run({"verify", result_, "--time-limit", "0.02"});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("not checked: checking the plan takes longer than --time-limit 0.02 s"));
  EXPECT_EQ(outcome.out, "");
  EXPECT_EQ(verify().code, 0);
}

TEST_F(ProgramResult, IsPlottedAndExported) {
  ASSERT_EQ(plan().code, 0);
  EXPECT_EQ(run({"plot", result_, "--out", folder_.path("plot.svg")}).code, 0);
  EXPECT_THAT(folder_.read("plot.svg"), HasSubstr("<svg"));
  EXPECT_EQ(run({"plot", result_, "--out", folder_.path("p.svg"), "--corner", "A"}).code, 2);
  const Outcome csv = run({"export", result_, "--format", "csv"});
  EXPECT_EQ(csv.code, 0) << csv.err;
  const std::string table = csv.out.substr(0, csv.out.find('#'));
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 42) << "a head and 41 taps";
  EXPECT_THAT(csv.out, HasSubstr("\n# delay_samples,line "));
}

// A program whose arcs, rapid moves and tight limits once made what was written plan to two samples more: a plan that
// brings its delays along holds as it is.
TEST_F(ProgramResult, WhatWasWrittenIsNotPlannedAnew) {
  folder_.write("mill.toml", R"(sample_period_ms=4.0
[filter]
kind="boxcar"
order=42
[[axis]]
name="x"
velocity_max_mm_s=51.795106156217415
acceleration_max_mm_s2=418.05556831567407
jerk_max_mm_s3=9581.15695818172
[[axis]]
name="y"
velocity_max_mm_s=51.795106156217415
acceleration_max_mm_s2=370.3111851575764
jerk_max_mm_s3=8486.932975584547
[[axis]]
name="z"
velocity_max_mm_s=51.795106156217415
acceleration_max_mm_s2=465.27661470549276
jerk_max_mm_s3=10663.386909126426
mass_kg=20.0
damping_N_s_m=50.0
force_max_N=11.247848774968007
power_max_W=0.21846882049820546
)");
  folder_.write("part.ngc", R"(G21 G90 G17 G64 P0.1124 F1582.7
G1 X-14.7100 Y-10.5710 Z0.0000
G1 X-30.7750 Y-25.8875 Z0.0000
G1 X-27.2632 Y-33.1708 Z0.0000
G1 X-13.0099 Y-17.3334 Z0.0000
G3 X-9.4976 Y-13.3786 I-14.9803 J16.8415
G1 X26.6793 Y1.4575 Z0.0000
G3 X15.5537 Y0.7253 I-5.6651 J1.1885
G1 X4.4398 Y-7.8211 Z0.0000
G3 X6.9996 Y-19.8138 I-0.3211 J-6.3381
G0 X21.7329 Y-4.4215 Z-12.3637
G1 X-18.8707 Y-2.7487 Z-23.4805
G0 X-14.7828 Y-31.0140 Z-23.4805
M2
)");
  const std::string written = folder_.path("written.ngc"), again = folder_.path("again.json");
  for (const char* feeds : {"choose", "keep"}) {
    ASSERT_EQ(plan({"--feeds", feeds, "--emit", written}).code, 0);
    ASSERT_EQ(
        run({"program", written, "--task", task_, "--feeds", feeds, "--dwells-before-filter", "--json", again}).code,
        0);
    EXPECT_EQ(Json::parse(folder_.read("again.json"))["samples"], json()["samples"]) << feeds;
    EXPECT_EQ(run({"verify", again}).code, 0) << feeds;
  }
}

TEST_F(ProgramResult, LimitsAreGivenInTheirUnits) {
  const Outcome planned = run({"program", program_, "--task", task_});
  EXPECT_THAT(planned.out, ::testing::ContainsRegex("acceleration +x +[0-9.]+ +3000 mm/s\\^2"));
  EXPECT_THAT(planned.out, ::testing::ContainsRegex("velocity +y +[0-9.]+ +200 mm/s"));
}

}  // namespace
}  // namespace accdec
