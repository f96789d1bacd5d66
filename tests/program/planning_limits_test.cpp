#include <atomic>
#include <cmath>
#include <filesystem>
#include <random>
#include <utility>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <accdec/plan/command/choose_feeds.hpp>
#include <accdec/plan/trajectory/plan_profiles.hpp>

#include "program_command.hpp"
#include "reference.hpp"

// Limits of planning: filters too short for their limits, time limits, dwells of hours.

namespace accdec::planning_limits_test {
namespace {

using test::ProgramCommand;
using ::testing::HasSubstr;

Machine slow_axis() {
  Machine machine;
  Axis axis;
  axis.name = "x";
  axis.velocity_max = 1.0;
  axis.acceleration_max = 0.2;
  axis.jerk_max = 4.0;
  machine.axes.push_back(axis);
  return machine;
}

// Two equal taps under a jerk limit: a step of the command changes the acceleration by half of it over T, so it is at
// most 2 j T^2. One every T is an acceleration of 2 j T, which from rest to rest along L takes 2 sqrt(L/(2 j T)).
TEST(PlanningLimits, AFilterOfTwoTapsSpeedsUpAsFastAsItsStepsAllow) {
  const Machine machine = slow_axis();
  constexpr double T = 2e-4;
  for (const double length : {5.0, 50.0}) {
    const Toolpath path = test::path_of(fmt::format("G64 P0.05 F30000\nG1 X{}\nM2\n", length), machine);
    const ScheduledPlan plan = schedule_feeds(path, Filter({0.5, 0.5}), T, machine);
    ASSERT_TRUE(all_holds(plan.plan));
    const double time = static_cast<double>(plan.plan.simulation.samples) * T;
    const double least = 2.0 * std::sqrt(length * 1e-3 / (2.0 * 4.0 * T));
    EXPECT_GE(time, least);
    EXPECT_LE(time, 1.02 * least + 0.02);
  }
}

TEST(PlanningLimits, ADeadlineEndsMarchesAndRepair) {
  const Machine machine = slow_axis();
  const Toolpath path = test::path_of("G64 P0.05 F30000\nG1 X900\nM2\n", machine);
  const Deadline over(-1.0);
  // The plan that comes back need not hold, but it is one of the whole path.
  const ScheduledPlan plan = schedule_feeds(path, Filter({0.5, 0.5}), 2e-4, machine, 40, over);
  EXPECT_EQ(plan.plan.rounds, 0);
  EXPECT_EQ(plan_profiles(path, machine, 2e-4, over).rounds, 0);
}

// A plan that was cut short breaks limits, and its time is less than the feeds allow.
TEST(PlanningLimits, ProgrammedFeedsHaveNoTimeWhereTheirPlanWasNotFinished) {
  Task task;
  task.sample_period = 1e-3;
  task.machine = test::machine_of(1.0, unlimited, 0.2, 3);
  const Toolpath path = test::path_of("G61 F12000\nG2 J36 P2\nM2\n", task.machine);
  const Deadline over(-1.0);
  const ProgramResult result = run_program({"a", path, task, Feeds::choose, over}, Filter({0.5, 0.5}));
  EXPECT_TRUE(result.verification.feasible) << "with stops";
  EXPECT_FALSE(result.cycle_time_kept.has_value());
}

// A plan that held when the filter was chosen is made again without time for another.
TEST(PlanningLimits, AKnownPlanIsKeptWhenTheTimeEnds) {
  Task task;
  task.sample_period = 1e-3;
  task.machine = test::machine_of(4.0, 300.0, 0.5, 2);
  for (Axis& axis : task.machine.axes)
    axis.mass = 30.0, axis.damping = 100.0, axis.coulomb = 40.0, axis.force_max = 200.0;
  task.machine.axes[0].servo_gain = 150.0, task.machine.axes[1].servo_gain = 120.0;
  Toolpath path = test::path_of("G64 P0.06 F6000\nG1 X20\nG3 X20 Y20 J10\nG1 X0\nM2\n", task.machine);
  path.contour_max = 80e-6;
  const Filter filter = trapezoid(37, 13);
  const ProgramResult whole = run_program({"a", path, task}, filter);
  ASSERT_TRUE(whole.verification.feasible) << whole.message;
  const Deadline over(-1.0);
  const KnownPlan plan{whole.plan.path.duration, whole.plan.command()->delays};
  const ProgramResult known = run_program({"a", path, task, Feeds::choose, over}, filter, plan);
  EXPECT_TRUE(known.verification.feasible);
  EXPECT_EQ(known.check.samples, whole.check.samples);
  EXPECT_EQ(known.cycle_time_kept, known.cycle_time);
  // A plan that does not hold is no candidate.
  const KnownPlan wrong{plan.duration, std::vector<int>(plan.delays.size(), 0)};
  const ProgramResult other = run_program({"a", path, task, Feeds::choose, over}, filter, wrong);
  EXPECT_TRUE(other.verification.feasible) << other.message;
}

// An arc of 316 chords under a filter of 51 taps, which steps of the feed between them do not suit: mending it takes
// minutes. Then every chord ends with a stop.
TEST_F(ProgramCommand, APlanThatTheTimeLimitEndsStops) {
  write("long.toml",
        "sample_period_ms = 0.2\n[filter]\nkind = \"boxcar\"\norder = 50\n[[axis]]\nvelocity_max_mm_s = 500\n"
        "acceleration_max_mm_s2 = 200\njerk_max_mm_s3 = 4000\n");
  write("part.ngc",
        "G21 G90 G17\nG64 P0.154\nF40000\nG0 X-15.859421 Y-0.290778 Z-17.534912\n"
        "G3 Z-16.960746 I0.348903 J1.969331\nG1 Z-25.387611\n");
  const auto done = run("program part.ngc --task long.toml --time-limit 0.05 --json r.json");
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_THAT(done.out, HasSubstr("317 blocks slowed"));
  EXPECT_THAT(done.out, HasSubstr("verified: every sample simulated, all bounds hold"));
  EXPECT_THAT(done.err, HasSubstr("the time limit ended the search"));
}

// Checking samples may take longer than there is time. Then there is no plan, rather than one that nobody checked.
TEST(PlanningLimits, ADeadlineEndsTheCheckOfSamples) {
  Task task;
  task.sample_period = 1e-4;
  task.machine = slow_axis();
  task.machine.axes[0].acceleration_max = 2e-5;  // 50 s of speeding up are not steady
  const Toolpath path = test::path_of("G64 P0.05 F60\nG1 X100\nM2\n", task.machine);
  const ProgramResult whole = run_profiles({"a", path, task});
  EXPECT_TRUE(whole.verification.feasible);
  EXPECT_NEAR(static_cast<double>(whole.check.samples), 150.0 / 1e-4, 1e4);
  const std::atomic<bool> asked = true;
  Deadline ended;
  ended.end_when(asked);
  for (const auto& [deadline, who] : {std::pair(Deadline(-1.0), "the time limit"), std::pair(ended, "Ctrl-C")}) {
    const ProgramResult cut = run_profiles({"a", path, task, Feeds::choose, deadline});
    EXPECT_TRUE(cut.plan.empty());
    EXPECT_FALSE(cut.verification.feasible);
    EXPECT_EQ(cut.message, fmt::format("{} ended plan profiles before all its samples were checked", who));
  }
}

TEST_F(ProgramCommand, SteadyMotionIsNotCheckedSampleBySample) {
  write("long.toml",
        "sample_period_ms = 0.1\n[[axis]]\nvelocity_max_mm_s = 500\n"
        "acceleration_max_mm_s2 = 1000\njerk_max_mm_s3 = 20000\n");
  write("part.ngc", "G21 G90 G64 P0.05\nG1 X10000 F1\nM2\n");  // 6e9 samples
  for (const char* plan : {"profiles", "free"}) {
    const auto done = run(fmt::format("program part.ngc --task long.toml --time-limit 10 --plan {}", plan));
    EXPECT_EQ(done.code, 0) << done.err;
    EXPECT_THAT(done.out, HasSubstr("verified: every sample simulated, all bounds hold"));
    EXPECT_THAT(done.out, ::testing::Not(HasSubstr("not checked")));
  }
}

// Without time to check the samples of profiles, the answer is one filter, as with --plan fixed, which always ends.
TEST_F(ProgramCommand, WithoutTimeForItsSamplesTheAnswerHasOneFilter) {
  write("long.toml",
        "sample_period_ms = 0.1\n[[axis]]\nvelocity_max_mm_s = 500\n"
        "acceleration_max_mm_s2 = 0.1\njerk_max_mm_s3 = 20000\n");
  write("part.ngc", "G21 G90 G64 P0.05\nG1 X10000 F10000\nM2\n");  // 6e6 samples that are never steady
  for (const std::string plan : {"profiles", "free"}) {
    const auto done = run("program part.ngc --task long.toml --time-limit 0.001 --json r.json --plan " + plan);
    EXPECT_EQ(done.code, 0) << done.err;
    EXPECT_THAT(read("r.json"), HasSubstr("\"plan\": \"fixed\""));
  }
}

// A dwell only moves what comes after it: samples that stand still are not made one by one.
TEST(PlanningLimits, DwellsOfDaysAreRest) {
  const Machine machine = slow_axis();
  const auto plan = [&](const char* dwell) {
    const std::string text = fmt::format("G64 P0.05 F600\nG1 X1\n{}G1 X3\n{}M2\n", dwell, dwell);
    return plan_profiles(test::path_of(text, machine), machine, 1e-3);
  };
  const ProfilePlan none = plan("G4 P1\n"), days = plan("G4 P1000001\n");
  ASSERT_TRUE(none.holds() && days.holds());
  EXPECT_EQ(days.check.samples - none.check.samples, 2'000'000'000);
  ASSERT_EQ(days.check.limits.size(), none.check.limits.size());
  for (std::size_t i = 0; i < days.check.limits.size(); ++i)
    EXPECT_NEAR(days.check.limits[i].utilisation, none.check.limits[i].utilisation, 1e-9);
}

TEST_F(ProgramCommand, DwellsOfDaysAreDrawnAndAbsurdOnesRefused) {
  write("part.ngc", "G21 G64 P0.05 F3000\nG1 X10\nG4 P1000000\nG1 Y10\nM2\n");
  for (const char* plan : {"fixed", "profiles"}) {
    const auto drawn =
        run(std::string("program part.ngc --task task.toml --figure f.svg --json r.json --plan ") + plan);
    EXPECT_EQ(drawn.code, 0) << drawn.err;
    EXPECT_GT(number_of("r.json", "cycle_time_s"), 1e6);
    EXPECT_EQ(run("verify r.json").code, 0) << read("out") << read("err");
    EXPECT_EQ(run(std::string("program part.ngc --task task.toml --figure f.html --plan ") + plan).code, 0);
  }
  write("part.ngc", "G21 G64 P0.05 F3000\nG1 X10\nG4 P10000000000\nG1 Y10\nM2\n");
  const auto refused = run("program part.ngc --task task.toml");
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.err, HasSubstr("part.ngc:3:"));
  EXPECT_THAT(refused.err, HasSubstr("the dwell takes more than 1e9 s"));
}

/// From rest to v, four equal taps take v/(4 T). So 10^-11 m/s^2 leave a feed at which 4 m take 5 10^12 s.
TEST_F(ProgramCommand, MovesLongerThanResultsMayHaveAreRefused) {
  write("slow.toml",
        "sample_period_ms = 20\n[[axis]]\nvelocity_max_mm_s = 300\nacceleration_max_mm_s2 = 1e-8\n"
        "[filter]\nkind = \"boxcar\"\norder = 3\n[program]\nerror_max_um = 10\n");
  write("slow.ngc", "F0.00026\nG1 X4000\nG1 X0\nM2\n");
  const auto refused = run("program slow.ngc --task slow.toml --feeds keep --json r.json");
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.err, HasSubstr("line 2: at the feed that the limits leave, the move takes more than 1e9 s"));
  // Chosen feeds rise from rest. Accelerations as small can be read again, though so many samples take too long.
  ASSERT_EQ(run("program slow.ngc --task slow.toml --plan profiles --json r.json").code, 0) << read("err");
  EXPECT_EQ(run("verify r.json").code, 1);
  EXPECT_THAT(read("err"), HasSubstr("r.json: not checked: simulating the plan again would take about"));
}

// Two circles that touch, under G61: widened arcs hold their joint only at feeds far below those of arcs as they are.
TEST_F(ProgramCommand, WideningArcsNeverTakesLonger) {
  write("arcs.toml",
        "sample_period_ms = 1.0\n[[axis]]\nvelocity_max_mm_s = 200\nacceleration_max_mm_s2 = 1000\n"
        "jerk_max_mm_s3 = 50000\n");
  for (const char* turns : {"G2 I5\nG2 I6\n"}) {
    write("part.ngc", std::string("G21 G90 G17 G61 F6000\n") + turns + "M2\n");
    ASSERT_EQ(run("program part.ngc --task arcs.toml --json plain.json").code, 0) << read("err");
    const auto done = run("program part.ngc --task arcs.toml --compensate-arcs --json r.json");
    ASSERT_EQ(done.code, 0) << done.err;
    EXPECT_LE(number_of("r.json", "cycle_time_s"), number_of("plain.json", "cycle_time_s") + 1e-9);
    EXPECT_THAT(done.out, HasSubstr("arcs are commanded as programmed"));
    EXPECT_NE(read("r.json").find("\"compensation\": \"arcs are commanded as programmed"), std::string::npos);
    EXPECT_EQ(run("verify r.json").code, 0) << read("out");
  }
}

// Under a jerk limit alone, the filter that suits the programmed feeds is tried, too.
TEST_F(ProgramCommand, ChosenFeedsAreNeverSlowerThanKeptOnes) {
  write("jerk.toml",
        "sample_period_ms = 1\n[[axis]]\nvelocity_max_mm_s = 200\njerk_max_mm_s3 = 5000\n[program]\n"
        "error_max_um = 50\n");
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::vector<std::string> programs{"F300 G64 P0.05 G1 X100\nG1 Y50\nM2\n"};
  for (int i = 0; i < 6; ++i) {
    std::string text = fmt::format("G91 G64 P0.05 F{:.0f}\n", 300.0 + 2000.0 * unit(random));
    for (int b = 0; b < 4; ++b)
      text += fmt::format("G1 X{:.4f} Y{:.4f}\n", 60.0 * unit(random) - 30.0, 60.0 * unit(random) - 30.0);
    programs.push_back(text + "M2\n");
  }
  for (const std::string& text : programs) {
    write("part.ngc", text);
    double seconds[2] = {0.0, 0.0};
    for (const char* feeds : {"keep", "choose"}) {
      ASSERT_EQ(run(fmt::format("program part.ngc --task jerk.toml --json r.json --feeds {}", feeds)).code, 0)
          << read("err");
      seconds[feeds[0] == 'c' ? 1 : 0] = number_of("r.json", "cycle_time_s");
    }
    EXPECT_LE(seconds[1], seconds[0] * (1.0 + 1e-12)) << text;
  }
}

}  // namespace
}  // namespace accdec::planning_limits_test
