#include <cmath>
#include <random>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <accdec/filter.hpp>
#include <accdec/plan/command/choose_feeds.hpp>
#include <accdec/plan/command/stop_everywhere.hpp>
#include <accdec/plan/delays/pairwise_delays.hpp>
#include <accdec/plan/feeds/split_blocks.hpp>
#include <accdec/plan/run/other_rules.hpp>
#include <accdec/program.hpp>

#include "program_command.hpp"
#include "reference.hpp"

// The plan for want of another, and the programs that need it.

namespace accdec {
namespace {

using test::ProgramCommand;

TEST(StopEverywhere, HoldsWhateverTheProgram) {
  for (unsigned seed = 1; seed <= 12; ++seed) {
    Machine machine = test::machine_of(0.5 + 0.3 * seed, unlimited, 1.0, 3);
    for (Axis& axis : machine.axes) {
      if (seed % 2 == 0) axis.jerk_max = 20.0 * seed;
      if (seed % 3 == 0) axis.mass = 30.0, axis.damping = 100.0, axis.force_max = 40.0, axis.power_max = 5.0;
    }
    const Toolpath path = test::path_of(test::random_program(seed, 200), machine);
    for (const Filter& filter : {boxcar(7), trapezoid(60, 20), Filter({0.5, 0.5}), blackman_sinc(40, 0.049)}) {
      const ScheduledPlan plan = stop_everywhere(path, filter, test::period, machine);
      EXPECT_TRUE(all_holds(plan.plan)) << seed << ", " << filter.order();
      for (std::size_t b = 0; b < path.blocks(); ++b) EXPECT_GE(plan.path.duration[b], path.duration[b]);
    }
  }
}

// At low feeds exact stops surely hold all limits, and are not simulated. At high feeds they break some.
TEST(OtherRules, SaysOfExactStopsWhatTheirSimulationFinds) {
  int held = 0, broken = 0;
  for (unsigned seed = 1; seed <= 8; ++seed) {
    Machine machine = test::machine_of(2.0 + seed, unlimited, 1.0, 3);
    for (Axis& axis : machine.axes) axis.jerk_max = seed % 2 == 0 ? 100.0 * seed : unlimited;
    for (const double slower : {1.0, 4.0, 16.0, 64.0}) {
      Toolpath path = test::path_of(test::random_program(seed, 200), machine);
      for (double& duration : path.duration) duration *= slower;
      for (const Filter& filter : {boxcar(7), trapezoid(60, 20), Filter({0.5, 0.5}), blackman_sinc(40, 0.049)}) {
        const OtherRules times = other_rules(path, filter, test::period, machine);
        std::vector<int> delays = pairwise_delays(path, filter, test::period, machine, DelayRule::exact_stop).delays;
        ProgramPlan plan = check_program(path, filter, test::period, machine, delays);
        if (!all_holds(plan)) {
          for (int& delay : delays) delay += delay > 0 ? 1 : 0;
          plan = check_program(path, filter, test::period, machine, delays);
        }
        SCOPED_TRACE(fmt::format("{}, {}, {}", seed, slower, filter.order()));
        EXPECT_EQ(times.breaks.empty(), all_holds(plan)) << times.breaks;
        EXPECT_DOUBLE_EQ(times.exact_stop, static_cast<double>(plan.simulation.samples) * test::period);
        ++(all_holds(plan) ? held : broken);
      }
    }
  }
  EXPECT_GT(held, 20);
  EXPECT_GT(broken, 20);
}

// A block in two pieces of one feed is one block: the operator's exact stops are at its end alone.
TEST(OtherRules, StepsOfTheFeedAreNoStops) {
  const Machine machine = test::machine_of(3.0, unlimited, 1.0, 3);
  const Toolpath path = test::path_of(test::random_program(3, 200), machine);
  std::vector<FeedPiece> pieces;
  for (std::size_t b = 0; b < path.blocks(); ++b) {
    double length2 = 0.0;
    for (std::size_t a = 0; a < 3; ++a) length2 += std::pow(path.point(b + 1)[a] - path.point(b)[a], 2);
    const double half = 0.5 * std::sqrt(length2);
    const auto block = static_cast<std::uint32_t>(b);
    for (int i = 0; i < 2; ++i) pieces.push_back({block, half, 2.0 * half / path.duration[b], 0.0});
  }
  const OtherRules whole = other_rules(path, boxcar(7), test::period, machine);
  const OtherRules split = other_rules(split_blocks(path, pieces), boxcar(7), test::period, machine);
  EXPECT_DOUBLE_EQ(split.exact_stop, whole.exact_stop);
  EXPECT_DOUBLE_EQ(split.no_delay, whole.no_delay);
  EXPECT_EQ(split.breaks.empty(), whole.breaks.empty());
}

// The exact stops of a long program take the time that their simulation takes, even if it ends early at a broken limit.
TEST(OtherRules, LongProgramsThatBeginBrokenAreNotSimulatedToTheirEnd) {
  const Machine machine = test::machine_of(0.5, unlimited, 1.0, 3);
  const Toolpath path = test::path_of(test::random_program(5, 210'000), machine);
  ASSERT_GT(path.blocks(), several_plans_max);
  const Filter filter = boxcar(7);
  const OtherRules times = other_rules(path, filter, test::period, machine);
  EXPECT_THAT(times.breaks, testing::StartsWith("acceleration"));
  std::vector<int> delays = pairwise_delays(path, filter, test::period, machine, DelayRule::exact_stop).delays;
  for (int& delay : delays) delay += delay > 0 ? 1 : 0;
  const ProgramPlan plan = check_program(path, filter, test::period, machine, delays);
  EXPECT_FALSE(all_holds(plan));
  EXPECT_DOUBLE_EQ(times.exact_stop, static_cast<double>(plan.simulation.samples) * test::period);
}

// From rest to rest, steps of a tau every tau through an average of tau take L/v + v/a. That is 0.3 s for 20 mm at
// 100 mm/s and 1 m/s^2. One step reaches 20 mm/s at most, which takes 1 s.
TEST(StopEverywhere, StepsOfTheFeedInsideBlocksSaveMostOfTheTime) {
  const Machine machine = test::machine_of(1.0, unlimited, 0.5, 2);
  std::string text = "G64 P0.001 F6000\n";
  constexpr int moves = 40;
  for (int i = 1; i <= moves; ++i) text += fmt::format("G1 {}{}\n", i % 2 == 0 ? 'Y' : 'X', (i + 1) / 2 * 20);
  const Toolpath path = test::path_of(text + "M2\n", machine);
  const Filter filter = boxcar(19);
  const auto steps = schedule_stops(path, filter, test::period, machine, Deadline{});
  ASSERT_TRUE(steps);
  EXPECT_TRUE(all_holds(steps->plan));
  const auto seconds = [](const ScheduledPlan& plan) { return plan.plan.simulation.samples * test::period; };
  EXPECT_GE(seconds(*steps), moves * 0.3 - 1e-9);
  EXPECT_LE(seconds(*steps), moves * 0.3 * 1.02);
  EXPECT_GE(seconds(stop_everywhere(path, filter, test::period, machine)), moves * 1.0);
  EXPECT_FALSE(schedule_stops(path, filter, test::period, machine, Deadline(-1.0)));
}

// 1000 moves within a moment: a plan that holds, not one that breaks a limit. So many have a record that is checked.
TEST_F(ProgramCommand, AShortTimeLimitGivesASlowPlan) {
  write("jerk.toml",
        "sample_period_ms = 1\n[[axis]]\nvelocity_max_mm_s = 200\nacceleration_max_mm_s2 = 1000\n"
        "jerk_max_mm_s3 = 50000\n[program]\nerror_max_um = 20\n");
  std::mt19937 random(24);
  std::uniform_real_distribution<double> place(0.0, 50.0);
  std::string text = "G21 G90 F6000 G64 P0.01\n";
  for (int i = 0; i < 1000; ++i) text += fmt::format("G1 X{:.3f} Y{:.3f}\n", place(random), place(random));
  write("part.ngc", text + "M2\n");
  for (const char* feeds : {"choose", "keep"}) {
    const auto done =
        run(fmt::format("program part.ngc --task jerk.toml --time-limit 0.02 --json r.json --feeds {}", feeds));
    EXPECT_EQ(done.code, 0) << done.out << done.err;
    EXPECT_THAT(done.err, testing::HasSubstr("the time limit ended the search"));
    const auto verified = run("verify r.json");
    EXPECT_EQ(verified.code, 0) << verified.out << verified.err;
  }
}

// Chords of at least 0.3 mm. With a stop at each they take 4 (L/(2 j))^(1/3), 58 ms, and not the 3 ms of their feed.
// The time limit leaves time for one plan, which runs through them.
TEST_F(ProgramCommand, AShortTimeLimitLeavesTimeForOnePlan) {
  write("jerk.toml",
        "sample_period_ms = 1\n[[axis]]\nvelocity_max_mm_s = 200\nacceleration_max_mm_s2 = 1000\n"
        "jerk_max_mm_s3 = 50000\n[program]\nerror_max_um = 20\n");
  std::string text = "G21 G90 F6000 G64 P0.05\n";
  constexpr int chords = 3000;
  for (int i = 1; i <= chords; ++i) text += fmt::format("G1 X{:.4f} Y{:.4f}\n", 0.3 * i, 2.0 * std::sin(0.1 * i));
  write("part.ngc", text + "M2\n");
  ASSERT_EQ(run("program part.ngc --task jerk.toml --time-limit 0.02 --json r.json").code, 0) << read("err");
  EXPECT_EQ(run("verify r.json").code, 0) << read("out") << read("err");
  const double stops = chords * 4.0 * std::cbrt(0.3e-3 / (2.0 * 50.0));
  EXPECT_LT(number_of("r.json", "cycle_time_s"), 0.25 * stops);
}

}  // namespace
}  // namespace accdec
