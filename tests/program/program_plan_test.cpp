#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <accdec/bounds/lower_bound.hpp>
#include <accdec/corner.hpp>
#include <accdec/filter.hpp>
#include <accdec/gcode/read_error.hpp>
#include <accdec/plan/command/program_plan.hpp>
#include <accdec/plan/delays/path_delay.hpp>
#include <accdec/plan/feeds/stretches.hpp>
#include <accdec/plan/trajectory/plan_profiles.hpp>
#include <accdec/simulate/simulate.hpp>

#include "reference.hpp"
#include "support/tries.hpp"

namespace accdec {
namespace {

using test::path_of;
using test::period;
using test::random_program;
using test::Reference;

TEST(Plan, EveryJointHoldsItsToleranceOnThePathByDefinition) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    Toolpath path = path_of(random_program(seed, 400));
    const Filter filter = seed % 2 == 0 ? boxcar(30) : blackman_sinc(40, 0.049);
    const ProgramPlan plan = plan_program(path, filter, period, {});
    EXPECT_TRUE(plan.errors_hold);
    EXPECT_GT(raised_delays(path, filter, period, {}, plan.delays) + plan.slowed, 0U)
        << "short moves must overlap in this test";
    const Reference reference(path, filter, period, plan.delays);
    for (std::size_t b = 0; b + 1 < path.blocks(); ++b) {
      EXPECT_LE(reference.error(path, filter.order(), b), path.tolerance[b] * (1.0 + 1e-9) + 1e-12)
          << "seed " << seed << " joint " << b;
    }
  }
}

// The joint turns too little for a stop, so it may be passed at a feed that the filter cannot start. Its tolerance asks
// for a delay, and then the filter must.
TEST(Plan, LongBlocksBesideADelayAreSlowedToWhatTheFilterStarts) {
  const Machine machine = test::machine_of(6.0, 500.0, 0.5);
  for (const double turn : {4.0, 9.0, 15.0, 19.0}) {
    for (const double tolerance : {0.002, 0.01}) {
      const double angle = turn * std::numbers::pi / 180.0;
      Toolpath path = path_of(fmt::format("G64 P{} F6000\nG1 X100\nG1 X{} Y{}\n", tolerance,
                                          100.0 + 90.0 * std::cos(angle), 90.0 * std::sin(angle)),
                              machine);
      const Filter filter = trapezoid(23, 6);  // averages of 18 and 7 samples: 100 mm/s at once are 794 m/s^3
      const ProgramPlan plan = plan_program(path, filter, period, machine);
      EXPECT_TRUE(all_holds(plan)) << turn << " degrees, " << tolerance;
      const Reference reference(path, filter, period, plan.delays);
      EXPECT_LE(reference.error(path, filter.order(), 0), path.tolerance[0] * (1.0 + 1e-9) + 1e-12);
    }
  }
}

TEST(Plan, StretchesAreBlocksOfTheProgram) {
  std::string text = "G64 P0.05 F600\n";
  for (int i = 1; i <= 60; ++i) text += "G1 X" + std::to_string(i) + "\n";
  const Toolpath path = path_of(text);
  for (const std::size_t whole_max : {std::size_t{8}, std::size_t{40}, std::size_t{56}, path.blocks() - 1}) {
    const std::vector<Toolpath> parts = stretches(path, whole_max);
    ASSERT_EQ(parts.size(), 4U);
    for (const Toolpath& part : parts) {
      ASSERT_EQ(part.blocks(), whole_max / 4);
      for (std::size_t b = 0; b <= part.blocks(); ++b)
        EXPECT_NEAR(part.point(b)[0], part.point(0)[0] + 1e-3 * static_cast<double>(b), 1e-12) << whole_max << " " << b;
      EXPECT_LE(part.point(part.blocks())[0], path.point(path.blocks())[0]);
      EXPECT_LE(part.line.back(), path.line.back());
    }
  }
  EXPECT_EQ(stretches(path, path.blocks()).size(), 1U);
}

TEST(Plan, ADelayRaisedByOverlapCannotBeOneShorter) {
  Toolpath path = path_of(random_program(5, 200));
  const Filter filter = boxcar(30);
  const ProgramPlan plan = plan_program(path, filter, period, {});
  const std::vector<int> pairwise = pairwise_delays(path, filter, period).delays;
  int checked = 0;
  for (std::size_t b = 0; b + 1 < path.blocks(); ++b) {
    if (plan.delays[b] <= pairwise[b]) continue;
    // Lowered in order of the program, each against its surroundings of that moment; the last raised one is minimal for
    // certain.
    bool last = true;
    for (std::size_t c = b + 1; c < path.blocks(); ++c) last = last && plan.delays[c] <= pairwise[c];
    if (!last) continue;
    std::vector<int> shorter = plan.delays;
    --shorter[b];
    const Reference reference(path, filter, period, shorter);
    bool all = true;
    for (std::size_t c = 0; c + 1 < path.blocks(); ++c)
      all = all && holds(reference.error(path, filter.order(), c), path.tolerance[c]);
    EXPECT_FALSE(all);
    ++checked;
  }
  EXPECT_EQ(checked, 1);
}

TEST(Plan, LoneCornersGetTheirSmallestDelay) {
  std::string text = "G91 G1 F6000 X30\n";
  for (int i = 1; i <= 17; ++i) {
    text +=
        "G64 P0.0" + std::to_string(i) + " X" + std::to_string(20 - 3 * i) + " Y" + std::to_string(25 + i) + "\nX30\n";
  }
  Toolpath path = path_of("G64 P0.02\n" + text);
  const Filter filter = blackman_sinc(40, 0.049);
  const ProgramPlan plan = plan_program(path, filter, period, {});
  EXPECT_TRUE(plan.errors_hold);
  EXPECT_EQ(raised_delays(path, filter, period, {}, plan.delays), 0U);
  for (std::size_t b = 0; b + 1 < path.blocks(); ++b) {
    if (path.joint[b] != Joint::corner) continue;
    const auto leg = [&](std::size_t i) {
      return Eigen::Vector2d(path.point(i + 1)[0] - path.point(i)[0], path.point(i + 1)[1] - path.point(i)[1]);
    };
    // Whole samples: the feed a block really has is its length over ceil of its duration.
    const auto feed = [&](std::size_t i) {
      return leg(i).norm() / (std::ceil(path.duration[i] / period - 1e-9) * period);
    };
    const Corner corner = make_corner(leg(b), leg(b + 1), feed(b), feed(b + 1));
    int smallest = 0;
    while (measure(Blend(filter, corner, smallest, period)).corner_error > path.tolerance[b]) ++smallest;
    EXPECT_EQ(plan.delays[b], smallest) << "joint " << b;
  }
}

TEST(Plan, SmallestPathDelayIsTheFirstWhosePolylineHolds) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  const Filter filter = blackman_sinc(40, 0.049);
  for (int i = 0; i < 300; ++i) {
    const double turn = smooth_turn * unit(random), v1 = 0.02 + unit(random), v2 = 0.02 + unit(random);
    const double bound = 1e-6 * std::pow(100.0, unit(random));
    const Corner corner = planar_corner(std::numbers::pi - turn, 0.0, Turn::left, v1, v2);
    const int d = smallest_path_delay(filter, corner.cos_interior(), v1 * period, v2 * period, bound, 40);
    int expected = 0;
    while (measure(Blend(filter, corner, expected, period)).polyline_error > bound) ++expected;
    EXPECT_EQ(d, expected);
  }
}

TEST(Plan, DelaysGrowUntilTheAxisLimitsHoldWhereLegsOverlap) {
  // A reversal at full acceleration: the boxcar uses the whole limit for each leg, so the legs may not overlap at all.
  Machine machine;
  machine.axes.push_back({"x", 0.2, 2.5});
  const Filter filter = boxcar(39);
  Toolpath path = path_of("G64 P10\nG1 F6000 X50\nX0\n", machine);
  EXPECT_EQ(pairwise_delays(path, filter, period).delays[0], 0);
  EXPECT_EQ(pairwise_delays(path, filter, period, machine).delays[0], 40);
  machine.axes[0].acceleration_max = 5.0;
  EXPECT_EQ(pairwise_delays(path, filter, period, machine).delays[0], 0);
}

TEST(Plan, ShortMovesTogetherHoldTheLimitsThatEachAloneHolds) {
  std::size_t raised = 0;
  for (unsigned seed = 1; seed <= unsigned{test_support::tries(6)}; ++seed) {
    Machine machine;
    const Filter filter = trapezoid(30, 6);
    // Each axis can just start the fastest block, 6000 mm/min, from rest.
    double top = 0.0, edge = 0.0;
    for (int i = 0; i <= 31; ++i) {
      top = std::max(top, filter.tap(i));
      edge = std::max(edge, std::abs(filter.tap(i) - filter.tap(i - 1)));
    }
    for (const char* name : {"x", "y", "z"})
      machine.axes.push_back({name, 0.2, 0.1 * top / period, 0.1 * edge / period / period});
    Toolpath path = path_of(random_program(seed, 300), machine);
    const ProgramPlan plan = plan_program(path, filter, period, program_machine(machine, path));
    EXPECT_TRUE(plan.errors_hold);
    raised += raised_delays(path, filter, period, program_machine(machine, path), plan.delays);
    for (const LimitUse& use : plan.simulation.limits)
      EXPECT_LE(use.utilisation, 1.0 + 1e-9) << to_string(use.kind) << use.axis;
    const Reference reference(path, filter, period, plan.delays);
    double acceleration = 0.0;
    for (std::size_t k = 2; k < reference.position.size(); ++k) {
      for (std::size_t a = 0; a < path.dimensions(); ++a) {
        const double change =
            reference.position[k][a] - 2.0 * reference.position[k - 1][a] + reference.position[k - 2][a];
        acceleration = std::max(acceleration, std::abs(change) / (period * period));
      }
    }
    EXPECT_LE(acceleration, 0.1 * top / period * (1.0 + 1e-6));
    for (std::size_t b = 0; b + 1 < path.blocks(); ++b) {
      EXPECT_LE(reference.error(path, filter.order(), b), path.tolerance[b] * (1.0 + 1e-9) + 1e-12);
    }
  }
  EXPECT_GT(raised, 0U);
}

TEST(Plan, ADwellAtTheEndTakesItsTime) {
  // 1 s of motion, 41 samples to come to rest, then 5 s; a filter a leg and the plan's own time model say the same.
  Toolpath path = path_of("G1 X10 F600\nG4 P5\nM2\n");
  const Filter filter = boxcar(40);
  const ProgramPlan plan = plan_program(path, filter, period, {});
  EXPECT_EQ(plan.simulation.samples, 1000 + 41 + 5000);
  EXPECT_EQ(motion_samples(CommandTiming(path, period, plan.delays), filter), 1000 + 41 + 5000);
  EXPECT_DOUBLE_EQ(program_lower_bound(path, {}, period), 6.0);
}

TEST(Plan, StraightAndToleratedJointsCostNothing) {
  const Filter filter = boxcar(40);
  Toolpath straight = path_of("G61 G1 F6000 X10\nX20 F3000\nX30\n");
  const ProgramPlan plan = plan_program(straight, filter, period, {});
  EXPECT_TRUE(plan.errors_hold);
  EXPECT_EQ(plan.simulation.samples, 100 + 200 + 200 + 41);
}

TEST(Plan, ALoneShortBlockIsSlowedUntilItsStartAndStopHoldTogether) {
  // Six samples at 100 mm/s through 10 taps: the ends of the start and the beginning of the stop have jerk of one sign,
  // and meet.
  Machine machine;
  const Filter filter = trapezoid(9, 3);
  machine.axes.push_back({"x", 1.0, 100.0, 0.1 * std::abs(filter.tap(1) - filter.tap(0)) * 1.01 / (period * period)});
  Toolpath path = path_of("G1 F6000 X0.6\n", machine);
  const ProgramPlan plan = plan_program(path, filter, period, machine);
  for (const LimitUse& use : plan.simulation.limits) EXPECT_LE(use.utilisation, 1.0 + 1e-9);
  EXPECT_EQ(plan.slowed, 1U);
}

TEST(Plan, AFeedTooFastForTheFilterIsLoweredToTheLargestThatHolds) {
  // A start through the taps b has jerk v |b_i - b_(i-1)|/T^2, so the largest speed is known; other blocks keep their
  // feeds.
  const Filter filter = trapezoid(40, 10);
  double edge = 0.0;
  for (int i = 0; i <= 41; ++i) edge = std::max(edge, std::abs(filter.tap(i) - filter.tap(i - 1)));
  const double jerk = 500.0, fastest = jerk * period * period / edge;
  Machine machine;
  for (const char* name : {"x", "y"}) machine.axes.push_back({name, 0.5, 6.0, jerk});
  Toolpath path = path_of("G64 P0.05\nG1 F12000 X100\nY100\nF3000 X0\nF12000 Y0\n", machine);
  const Toolpath before = path;
  const ProgramPlan plan = plan_program(path, filter, period, machine);
  EXPECT_TRUE(plan.errors_hold);
  for (const LimitUse& use : plan.simulation.limits)
    EXPECT_LE(use.utilisation, 1.0 + 1e-9) << to_string(use.kind) << use.axis;
  for (const std::size_t b : {0, 1, 3}) EXPECT_NEAR(0.1 / path.duration[b], fastest, 1e-9 * fastest) << b;
  EXPECT_EQ(path.duration[2], before.duration[2]);
  EXPECT_EQ(plan.slowed, 3U);
  ASSERT_EQ(plan.too_fast.size(), 2U);
  EXPECT_EQ(plan.too_fast[0].limit, "jerk x");
  EXPECT_EQ(plan.too_fast[0].blocks, 1U);
  EXPECT_EQ(plan.too_fast[0].line, 2U);
  EXPECT_NEAR(plan.too_fast[0].factor, fastest / 0.2, 1e-9);
  EXPECT_EQ(plan.too_fast[1].limit, "jerk y");
  EXPECT_EQ(plan.too_fast[1].blocks, 2U);
}

TEST(Plan, PowerAllowsTheFeedAtWhichItsPeakIsReached) {
  // Boxcar: v = V (k + 1)/(N + 1) under the force m V/((N + 1) T), so the largest power is m V^2/((N + 1) T).
  Machine machine;
  machine.axes.push_back({"x"});
  machine.axes[0].mass = 100.0;
  machine.axes[0].power_max = 2.0;
  const Filter filter = boxcar(39);
  Toolpath path = path_of("G1 F6000 X100\n", machine);
  const ProgramPlan plan = plan_program(path, filter, period, machine);
  const double fastest = std::sqrt(2.0 * 40.0 * period / 100.0);
  ASSERT_LT(fastest, 0.1);
  EXPECT_NEAR(0.1 / path.duration[0], fastest, 1e-3 * fastest);
  for (const LimitUse& use : plan.simulation.limits) EXPECT_LE(use.utilisation, 1.0 + 1e-9);
}

TEST(Plan, FeedsOnALegThatNeedNoStopAreKept) {
  // Twice the speed that can be started from rest, reached in two steps a filter apart.
  const Filter filter = boxcar(39);
  Machine machine;
  machine.axes.push_back({"x", 1.0, 0.1 / (40.0 * period)});
  Toolpath path = path_of("G61\nG1 F6000 X10\nF12000 X100\nF6000 X110\n", machine);
  const std::vector<double> before = path.duration;
  const ProgramPlan plan = plan_program(path, filter, period, machine);
  EXPECT_EQ(path.duration, before);
  EXPECT_TRUE(plan.too_fast.empty());
  for (const LimitUse& use : plan.simulation.limits) EXPECT_LE(use.utilisation, 1.0 + 1e-9);
}

std::string full_circle(const char* mode, double feed) {
  return std::string("G21 ") + mode + " F" + std::to_string(feed) + "\nG3 X0 Y0 I10 J0\n";
}

TEST(Plan, AnArcTooFastForItsToleranceIsPassedAtTheFeedThatNeedsNoStopsWhereThatIsFaster) {
  Machine machine;
  for (const char* name : {"x", "y"}) machine.axes.push_back({name, 0.5, 6.0, 500.0});
  const Filter filter = trapezoid(40, 10);
  // Steady motion around radius R with feed v stays inside by v^2 s^2 T^2/(2 R), s^2 the second moment of the taps
  // about their mean.
  double moment = 0.0;
  for (int i = 0; i <= 40; ++i) moment += filter.tap(i) * (i - filter.mean_delay()) * (i - filter.mean_delay());
  const double radius = 0.01, tolerance = 1e-5;
  const double steady = std::sqrt(2.0 * radius * tolerance / moment) / period;
  ASSERT_LT(steady, 0.1);
  Toolpath path = path_of(full_circle("G64 P0.01", 6000), machine);
  const ProgramPlan plan = plan_program(path, filter, period, machine);
  EXPECT_TRUE(plan.errors_hold);
  for (const LimitUse& use : plan.simulation.limits) EXPECT_LE(use.utilisation, 1.0 + 1e-9);
  const Reference reference(path, filter, period, plan.delays);
  for (std::size_t b = 0; b + 1 < path.blocks(); ++b)
    EXPECT_LE(reference.error(path, filter.order(), b), tolerance * (1.0 + 1e-9)) << b;
  // Chords lie inside the arc by up to an eighth of the tolerance, and the motion is judged at their ends with an
  // eighth less. Three quarters of the tolerance are left to the formula.
  const double around = 2.0 * std::numbers::pi * radius;
  EXPECT_LT(static_cast<double>(plan.simulation.samples) * period, around / (std::sqrt(0.75) * steady) + 41.0 * period);
  // A programmer's guess at a good feed is not faster.
  for (const double feed : {4000.0, 3000.0, 0.98 * steady * 60000.0, 2000.0}) {
    Toolpath slower = path_of(full_circle("G64 P0.01", feed), machine);
    const ProgramPlan other = plan_program(slower, filter, period, machine);
    EXPECT_LE(static_cast<double>(plan.simulation.samples), 1.01 * static_cast<double>(other.simulation.samples))
        << feed;
  }
}

TEST(Plan, AHigherFeedWordMakesNoArcMuchSlower) {
  Machine machine;
  for (const char* name : {"x", "y"}) machine.axes.push_back({name, 0.5, 6.0, 500.0});
  const Filter filter = trapezoid(40, 10);
  const auto time = [&](const std::string& text) {
    Toolpath path = path_of(text, machine);
    const ProgramPlan plan = plan_program(path, filter, period, machine);
    EXPECT_TRUE(plan.errors_hold);
    for (const LimitUse& use : plan.simulation.limits) EXPECT_LE(use.utilisation, 1.0 + 1e-9);
    return static_cast<double>(plan.simulation.samples);
  };
  const std::string line = "G21 G64 P0.005\nF6000\nG1 X10\n", arc = "G3 X12 Y2 I0 J2\nF6000 G1 Y12\n";
  for (const char* feed : {"F2000 ", "F1200 ", "F850 ", "F600 "})
    EXPECT_LE(time(line + arc), 1.01 * time(line + feed + arc)) << feed;
  for (const double feed : {3000.0, 1500.0, 1000.0, 700.0}) {
    EXPECT_LE(time(full_circle("G61", 6000.0)), 1.02 * time(full_circle("G61", feed))) << feed;
  }
}

TEST(Plan, LongLegsBesideACurveKeepTheirFeeds) {
  Machine machine;
  for (const char* name : {"x", "y"}) machine.axes.push_back({name, 0.5, 6.0, 500.0});
  Toolpath path = path_of("G21 G64 P0.005\nF6000\nG1 X100\nG3 X102 Y2 I0 J2\nG1 Y102\n", machine);
  const std::vector<double> before = path.duration;
  plan_program(path, trapezoid(40, 10), period, machine);
  EXPECT_NEAR(path.duration.front(), before.front(), 1e-9);
  EXPECT_NEAR(path.duration.back(), before.back(), 1e-9);
}

TEST(Plan, LowerBoundOfFineChordsKnowsWhatTurningTakes) {
  // A circle of radius R at F far above sqrt(a R): once around at that speed takes 2 pi sqrt(R/a). If a quarter's chord
  // is turned by 45 degrees, the acceleration along it is sqrt(2) a. Windows of a sixth to a quarter, and the
  // tolerance, reduce the bound by some tenths.
  Machine machine;
  for (const char* name : {"x", "y"}) machine.axes.push_back({name, 1.0, 1.0});
  const double turn = 2.0 * std::numbers::pi * std::sqrt(0.01);
  for (const double tolerance : {1.0, 10.0, 50.0}) {
    ToolpathOptions fine;
    fine.read.arc_tolerance = 1e-7;
    const std::string text = fmt::format("G64 P{}\nG1 X10 F60000\nG3 I10\nG1 X0\nM2\n", tolerance * 1e-3);
    LineSource source("circle.ngc", text);
    const Toolpath path = read_toolpath(source, machine, fine);
    const double bound = program_lower_bound(path, machine, period);
    EXPECT_GT(bound, 0.75 * turn) << tolerance;
    const ProfilePlan plan = plan_profiles(path, machine, period);
    ASSERT_TRUE(plan.holds());
    EXPECT_LT(bound, static_cast<double>(plan.check.samples) * period) << tolerance;
  }
}

// Rounding of the simulated path is that large; the bound would be loosened silently.
TEST(Plan, TolerancesBelowAPicometreAreRefused) {
  const auto read = [](const std::string& p) {
    const std::string text = "G64 P" + p + " F6000\nG1 X10\nG1 Y10\nM2\n";
    LineSource source("part.ngc", text);
    return read_toolpath(source, {}, {});
  };
  EXPECT_THAT([&] { read("0.0000000001"); }, ::testing::ThrowsMessage<ReadError>(::testing::StartsWith("part.ngc:2:")));
  EXPECT_THAT([&] { read("0.0000000001"); },
              ::testing::ThrowsMessage<ReadError>(::testing::HasSubstr("allowed is 0 or 1e-09 mm and more")));
  EXPECT_DOUBLE_EQ(read("0.000000002").tolerance.front(), 2e-12);
}

TEST(Plan, LowerBoundIsTheClosedFormWhereThereIsOne) {
  Machine machine;
  machine.axes.push_back({"x", 0.5, 1.0});
  machine.axes.push_back({"y", 0.5, 1.0});
  // 100 mm/s at 1 m/s^2: stops after each; along the diagonal sqrt(2) times as hard; then too short to reach the feed.
  const Toolpath stops = path_of("G61.1 G1 F6000 X50\nX80 Y30\nX80 Y34\n", machine);
  EXPECT_NEAR(program_lower_bound(stops, machine, 0.0),
              (0.5 + 0.1) + (0.3 * std::sqrt(2.0) + 0.1 / std::sqrt(2.0)) + 2.0 * std::sqrt(0.004), 1e-12);
  // Blended: legs less the tolerance, and ramps at both ends along their axes.
  const Toolpath blended = path_of("G64 P0.5 G1 F6000 X50\nY50\n", machine);
  EXPECT_NEAR(program_lower_bound(blended, machine, 0.0), 2.0 * (0.495 + 0.05), 1e-12);
  EXPECT_NEAR(program_lower_bound(path_of("G1 F6000 X50\nG4 P2\nX0\n"), {}, 0.0), 3.0, 1e-12);
  for (unsigned seed = 1; seed <= 5; ++seed) {
    Toolpath path = path_of(random_program(seed, 200));
    const double bound = program_lower_bound(path, {}, period);
    EXPECT_LE(bound, static_cast<double>(plan_program(path, boxcar(10), period, {}).simulation.samples) * period);
  }
}

}  // namespace
}  // namespace accdec
