#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "support/paths.hpp"
#include "support/run.hpp"

// Results of `accdec program` given to verify, plot and export.

namespace accdec {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;
using Json = nlohmann::ordered_json;

class ProgramResult : public ::testing::Test {
 protected:
  void SetUp() override {
    program_ = folder_.write("part.ngc",
                             "G21 G90 G64 P0.02\nF6000\nG1 X30 Y0\nX30 Y20 (up)\nG3 X20 Y30 I-10 J0\nG1 X0\nG4 P0.05\n"
                             "G61.1 G1 X0 Y10\nG64 P0.05\nX10 Y0\nX0 Y0\nM2\n");
    task_ =
        folder_.write("mill.toml",
                      "sample_period_ms = 1.0\n[filter]\nkind = \"trapezoid\"\norder = 40\nramp = 12\n[[axis]]\nname = "
                      "\"x\"\nvelocity_max_mm_s = 200\nacceleration_max_mm_s2 = 3000\njerk_max_mm_s3 = "
                      "300000\n[[axis]]\nname = \"y\"\nvelocity_max_mm_s = 200\nacceleration_max_mm_s2 = "
                      "3000\njerk_max_mm_s3 = 300000\n");
    result_ = folder_.path("result.json");
  }
  Outcome plan(std::vector<std::string> more = {}) {
    std::vector<std::string> arguments{"program", program_, "--task", task_, "--json", result_};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments);
  }
  Outcome verify() { return run({"verify", result_}); }
  Json json() const { return Json::parse(folder_.read("result.json")); }
  /// What verify says of a result that was changed.
  Outcome changed(const Json& json) {
    folder_.write("result.json", json.dump(1));
    return verify();
  }

  TemporaryFolder folder_;
  std::string program_, task_, result_;
};

TEST_F(ProgramResult, IsVerifiedFromItsOwnCommands) {
  for (const std::vector<std::string>& options :
       std::vector<std::vector<std::string>>{{}, {"--feeds", "keep"}, {"--plan", "per-leg"}, {"--rapid-stops"}}) {
    SCOPED_TRACE(::testing::PrintToString(options));
    const Outcome planned = plan(options);
    ASSERT_EQ(planned.code, 0) << planned.err;
    const Outcome checked = verify();
    EXPECT_EQ(checked.code, 0) << checked.out << checked.err;
    EXPECT_THAT(checked.out, StartsWith("accepted: "));
    EXPECT_THAT(checked.out, HasSubstr("read again: every programmed point in order"));
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
  rejected("another path", bad, "the path leaves it");
  bad = good;
  bad["limits"][1]["utilisation"] = 0.1;
  rejected("a limit used less", bad, "utilisation is recorded as");
  bad = good;
  bad["limits"].erase(1);
  rejected("a limit left out", bad, "but not recorded");
  bad = good;
  bad["commands"]["dwell"] = Json::array();
  rejected("no dwell", bad, "its dwell is not kept");
}

TEST_F(ProgramResult, SaysWhatWasNotComparedWithTheProgram) {
  ASSERT_EQ(plan().code, 0);
  folder_.write("part.ngc", "G21 G90 G64 P1\nF6000\nG1 X30 Y0\nM2\n");
  const Outcome checked = verify();
  EXPECT_EQ(checked.code, 0) << checked.out;
  EXPECT_THAT(checked.out, HasSubstr("has changed since"));
}

TEST_F(ProgramResult, WithoutCommandsItIsNotAccepted) {
  ASSERT_EQ(plan().code, 0);
  Json without = json();
  without["commands"] = nullptr;
  const Outcome outcome = changed(without);
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.out, HasSubstr("holds no commands"));
  // Damaged ones are bad input.
  ASSERT_EQ(plan().code, 0);
  Json damaged = json();
  damaged["commands"]["delay_samples"].erase(0);
  EXPECT_EQ(changed(damaged).code, 2);
  damaged = json();
  damaged["commands"]["duration_s"][0] = -1;
  EXPECT_EQ(changed(damaged).code, 2);
}

TEST_F(ProgramResult, CostsAreEstimatedFirst) {
  ASSERT_EQ(plan().code, 0);
  Json absurd = json();
  absurd["commands"]["delay_samples"][0] = 2000000000;
  const Outcome outcome = changed(absurd);
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.out, HasSubstr("would take about"));
}

TEST_F(ProgramResult, IsPlottedAndExported) {
  ASSERT_EQ(plan().code, 0);
  EXPECT_EQ(run({"plot", result_, "--out", folder_.path("plot.svg")}).code, 0);
  EXPECT_THAT(folder_.read("plot.svg"), HasSubstr("<svg"));
  EXPECT_EQ(run({"plot", result_, "--out", folder_.path("p.svg"), "--corner", "A"}).code, 2);
  const Outcome csv = run({"export", result_, "--format", "csv"});
  EXPECT_EQ(csv.code, 0) << csv.err;
  EXPECT_EQ(std::count(csv.out.begin(), csv.out.end(), '\n'), 42) << "a head and 41 taps";
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
