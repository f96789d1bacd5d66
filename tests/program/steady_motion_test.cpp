#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <accdec/filter.hpp>
#include <accdec/plan/report/samples.hpp>
#include <accdec/plan/trajectory/plan_profiles.hpp>
#include <accdec/plot/program_motion.hpp>
#include <accdec/program.hpp>
#include <accdec/simulate.hpp>
#include <accdec/simulate/profile_motion.hpp>
#include <accdec/simulate/sample_check.hpp>

#include "program_command.hpp"
#include "reference.hpp"

// Steady motion is passed over: what is seen of it is what its samples, made one by one, would show.

namespace accdec {
namespace {

using test::ProgramCommand;

/// Slow and fast moves, corners, a curve, a rapid move that turns back, dwells. At F6 a move takes 100 s.
constexpr const char* moves =
    "G4 P9\nG64 P0.05 F6\nG1 X10\nG1 Y7 F3000\nG1 X0 Y9 F12\nG1 X-0.5 Y9.1\nG1 X-1 Y9.3\nG0 Z5\nG0 Z0\nG4 P20\n"
    "G1 X30 F600\nG1 X-20 F400\nM2\n";

Task task_of(double acceleration, double jerk) {
  Task task;
  task.sample_period = 1e-3;
  task.machine = test::machine_of(acceleration, jerk, 0.2, 3);
  return task;
}

std::vector<ProgramResult> plans_of(const std::string& text) {
  std::vector<ProgramResult> plans;
  for (const double jerk : {unlimited, 50.0}) {
    const Task task = task_of(1.0, jerk);
    const Toolpath path = test::path_of(text, task.machine);
    plans.push_back(run_program({"a", path, task}, trapezoid(110, 40)));
    plans.push_back(run_program({"a", path, task, Feeds::choose}, trapezoid(110, 40)));
    plans.push_back(run_profiles({"a", path, task}));
  }
  return plans;
}

struct Seen {
  std::int64_t number;
  std::vector<double> x, v;
};

std::vector<Seen> samples_of(const ProgramResult& result, Steady steady) {
  const std::size_t n = result.plan.path.dimensions();
  std::vector<Seen> seen;
  const auto see = [&](std::int64_t k, const double* x, const double* v) {
    seen.push_back({k, {x, x + n}, {v, v + n}});
  };
  visit_samples(result, see, steady);
  return seen;
}

TEST(SteadyMotion, PassedOverIsWhatItsSamplesAre) {
  for (const ProgramResult& result : plans_of(moves)) {
    ASSERT_TRUE(result.verification.feasible) << result.message;
    const std::vector<Seen> all = samples_of(result, Steady::whole), some = samples_of(result, Steady::passed);
    ASSERT_EQ(static_cast<std::int64_t>(all.size()), result.check.samples + 1);
    EXPECT_LT(some.size(), all.size() / 5);
    EXPECT_EQ(some.back().number, all.back().number);
    std::size_t k = 0;
    double place = 0.0, speed = 0.0;
    for (const Seen& seen : some) {
      // Up to the next sample that is seen, the velocity is that of this next one.
      for (; k <= static_cast<std::size_t>(seen.number); ++k) {
        for (std::size_t a = 0; a < seen.x.size(); ++a) speed = std::max(speed, std::abs(all[k].v[a] - seen.v[a]));
      }
      for (std::size_t a = 0; a < seen.x.size(); ++a) place = std::max(place, std::abs(all[k - 1].x[a] - seen.x[a]));
    }
    // Profiles add a period to the time in the piece for every sample: 10^5 roundings of up to 100 s, at 50 mm/s.
    const double rounded =
        result.plan.trajectory() ? 1e5 * 0.5 * std::numeric_limits<double>::epsilon() * 100.0 * 0.05 : 0.0;
    EXPECT_LT(place, 1e-12 + rounded);
    EXPECT_LT(speed, 2e-9);
  }
}

TEST(SteadyMotion, LosesTheSameTimeAtEachJoint) {
  for (const ProgramResult& result : plans_of(moves)) {
    ASSERT_TRUE(result.verification.feasible) << result.message;
    // Twice the feeds, so that every sample of steady motion loses time.
    Toolpath programmed = test::path_of(moves, result.task_machine);
    for (double& duration : programmed.duration) duration *= 0.5;
    ProgramMotion motion = motion_of(result);
    const std::vector<CornerLoss> passed = time_lost(programmed, motion);
    motion.samples = [&](const SampleVisitor& visit) { visit_samples(result, visit); };
    const std::vector<CornerLoss> all = time_lost(programmed, motion);
    for (std::size_t i = 0; i < all.size(); ++i)
      EXPECT_NEAR(passed[i].time, all[i].time, 1e-3 * static_cast<double>(all[i].count) + 1e-9) << class_name(all[i]);
  }
}

TEST(SteadyMotion, IsCheckedAsItsSamplesAre) {
  for (const double jerk : {unlimited, 50.0}) {
    const Task task = task_of(1.0, jerk);
    const ProgramResult result = run_profiles({"a", test::path_of(moves, task.machine), task});
    const Toolpath& path = result.plan.path;
    const Trajectory& trajectory = *result.plan.trajectory();
    const Machine machine = program_machine(task.machine, path);
    std::vector<double> errors(path.blocks());
    SampleChecker checker(path, machine, task.sample_period, errors, {});
    ProfileMotion motion(path, trajectory.chain, task.sample_period, trajectory.last);
    while (motion.next()) checker.look(motion.position(), motion.place_first(), motion.place_last());
    const SampleCheck check = checker.finish();
    EXPECT_EQ(check.samples, result.check.samples);
    for (std::size_t b = 0; b < path.blocks(); ++b) EXPECT_NEAR(errors[b], result.errors[b], 1e-12) << b;
    for (std::size_t i = 0; i < check.limits.size(); ++i)
      EXPECT_NEAR(check.limits[i].utilisation, result.check.limits[i].utilisation, 1e-9) << i;
  }
}

/// Compares a motion made a piece at a time with the same motion made sample by sample.
void expect_same(const Plan& plan, const Filter& last, std::int64_t most) {
  const std::size_t n = plan.path.dimensions();
  ProfileMotion pieces(plan.path, plan.trajectory()->chain, 1e-3, last),
      samples(plan.path, plan.trajectory()->chain, 1e-3, last);
  std::vector<double> values(n * static_cast<std::size_t>(most));
  std::vector<std::int64_t> places(static_cast<std::size_t>(most));
  std::array<double*, program_axis_count> rows{};
  for (std::size_t a = 0; a < n; ++a) rows[a] = values.data() + a * static_cast<std::size_t>(most);
  std::int64_t in_runs = 0;
  while (pieces.next()) {
    ASSERT_TRUE(samples.next());
    const std::int64_t run = pieces.next_run(rows, places.data(), most);
    for (std::int64_t k = 0; k < run; ++k) {
      ASSERT_TRUE(samples.next());
      for (std::size_t a = 0; a < n; ++a) ASSERT_EQ(rows[a][k], samples.position()[a]);
      ASSERT_EQ(places[static_cast<std::size_t>(k)], samples.place_first());
    }
    ASSERT_EQ(pieces.place_last(), samples.place_last());
    for (std::size_t a = 0; a < n; ++a) ASSERT_EQ(pieces.position()[a], samples.position()[a]);
    ASSERT_EQ(pieces.pass_steady(), samples.pass_steady());
    in_runs += run;
  }
  EXPECT_FALSE(samples.next());
  EXPECT_GT(in_runs, 300);
}

TEST(SteadyMotion, OfAPieceAtATimeIsTheSameSampleBySample) {
  for (const double jerk : {unlimited, 50.0}) {
    const Task task = task_of(1.0, jerk);
    const ProgramResult result = run_profiles({"a", test::path_of(moves, task.machine), task});
    for (const Filter& last : {Filter({1.0}), boxcar(20), trapezoid(20, 7)}) expect_same(result.plan, last, 200);
    expect_same(result.plan, boxcar(20), 7);
  }
}

TEST(ProfileMotion, FarFromTheOriginIsRoundedOnce) {
  // Behind 1024 m a position is rounded by up to 1.1e-13 m, an acceleration at 1 ms by 4.5e-7 m/s^2. That is allowed
  // for, but plans leave only 1e-9 of the limit for more.
  std::string text = "G64 P0.05 F6000\n";
  for (int i = 1; i <= 2000; ++i)
    text += fmt::format("G1 X{:.2f} Y{:.2f}\n", 3.13 * (i % 7) + 0.01 * i, (i % 2 == 0 ? 7.31 : 0.42) + 0.17 * (i % 5));
  const Task task = task_of(1.0, unlimited);
  Toolpath path = test::path_of(text + "M2\n", task.machine);
  for (double& x : path.points) x += 1024.0;
  const ProfilePlan plan = plan_profiles(path, program_machine(task.machine, path), task.sample_period);
  EXPECT_TRUE(plan.holds());
  EXPECT_EQ(plan.rounds, 0);
}

TEST(SteadyMotion, PicturesKeepTheEndsOfWhatIsPassedOver) {
  const Task task = task_of(1.0, unlimited);
  const ProgramResult result = run_profiles({"a", test::path_of(moves, task.machine), task});
  const std::vector<Seen> some = samples_of(result, Steady::passed);
  const std::vector<std::int64_t> drawn = drawn_samples(motion_of(result), 200);
  EXPECT_LE(drawn.size(), 600U);
  EXPECT_EQ(drawn.front(), 0);
  EXPECT_EQ(drawn.back(), some.back().number);
  for (std::size_t i = 1; i < some.size(); ++i) {
    if (static_cast<double>(some[i].number - some[i - 1].number) < result.cycle_time / 1e-3 / 199.0) continue;
    EXPECT_TRUE(std::binary_search(drawn.begin(), drawn.end(), some[i - 1].number));
    EXPECT_TRUE(std::binary_search(drawn.begin(), drawn.end(), some[i].number));
  }
}

// Pictures of two plans have points at the same times, wherever both motions are not steady.
TEST(SteadyMotion, PicturesOfSeveralPlansHavePointsAtTheSameTimes) {
  const std::int64_t step = 7;
  for (const ProgramResult& result : plans_of(moves)) {
    const std::vector<std::int64_t> drawn = drawn_samples(motion_of(result), 2000, step);
    for (const Seen& seen : samples_of(result, Steady::passed)) {
      if (seen.number % step == 0) {
        EXPECT_TRUE(std::binary_search(drawn.begin(), drawn.end(), seen.number)) << seen.number;
      }
    }
    EXPECT_TRUE(std::is_sorted(drawn.begin(), drawn.end()));
    EXPECT_EQ(std::adjacent_find(drawn.begin(), drawn.end()), drawn.end());
  }
}

// 6.6 10^8 samples: made one by one, each picture took a minute.
TEST_F(ProgramCommand, SlowMovesOfAWeekAreDrawn) {
  write("part.ngc", "G21 G90 F0.00175\nG1 X10\nG1 X10 Y9\nM2\n");
  for (const char* plan : {"fixed", "profiles", "free"}) {
    for (const char* figure : {"f.svg", "f.html"}) {
      const auto drawn = run(fmt::format(
          "program part.ngc --task task.toml --time-limit 20 --figure {} --json r.json --plan {}", figure, plan));
      EXPECT_EQ(drawn.code, 0) << drawn.err;
      EXPECT_GT(number_of("r.json", "cycle_time_s"), 6e5);
    }
  }
}

}  // namespace
}  // namespace accdec
