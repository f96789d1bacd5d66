#include <cmath>
#include <random>
#include <tuple>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <accdec/filter.hpp>
#include <accdec/plan/command/choose_feeds.hpp>
#include <accdec/plan/command/stop_everywhere.hpp>
#include <accdec/plan/delays/joint_delays.hpp>
#include <accdec/plan/feeds/feed_caps.hpp>
#include <accdec/plan/filters/filter_search.hpp>

#include "reference.hpp"

namespace accdec {
namespace {

using test::path_of;
using test::period;
using test::random_program;
using test::Reference;

Machine machine_within(double velocity, double acceleration, double jerk = unlimited) {
  Machine machine;
  Axis axis;
  axis.velocity_max = velocity;
  axis.acceleration_max = acceleration;
  axis.jerk_max = jerk;
  for (const char* name : {"x", "y", "z"}) {
    axis.name = name;
    machine.axes.push_back(axis);
  }
  return machine;
}

/// The largest use of every limit, by differences of the positions of a plain convolution.
double worst_use(const Reference& reference, const Machine& machine) {
  double worst = 0.0;
  const auto at = [&](long k, std::size_t a) {
    const long last = static_cast<long>(reference.position.size()) - 1;
    return reference.position[static_cast<std::size_t>(std::clamp(k, 0L, last))][a];
  };
  for (long k = 1; k < static_cast<long>(reference.position.size()) + 3; ++k) {
    for (std::size_t a = 0; a < reference.n; ++a) {
      const Axis& axis = machine.axes[a];
      const double v = (at(k, a) - at(k - 1, a)) / period;
      const double acceleration = (at(k, a) - 2.0 * at(k - 1, a) + at(k - 2, a)) / (period * period);
      const double jerk =
          (at(k, a) - 3.0 * at(k - 1, a) + 3.0 * at(k - 2, a) - at(k - 3, a)) / (period * period * period);
      const double force = axis.mass * acceleration + axis.damping * v;
      worst = std::max({worst, std::abs(v) / axis.velocity_max, std::abs(acceleration) / axis.acceleration_max,
                        std::abs(jerk) / axis.jerk_max, std::abs(force) / axis.force_max, force * v / axis.power_max,
                        -force * v / axis.regeneration_max});
    }
  }
  return worst;
}

/// Everything a schedule promises, by a second computation. Rounding: positions of some 0.1 m to 1e-17, thrice
/// differenced over 1e-9 s^3.
void expect_holds(const ScheduledPlan& plan, const Filter& filter, const Machine& machine, const std::string& what) {
  ASSERT_TRUE(all_holds(plan.plan)) << what;
  const Reference reference(plan.path, filter, period, plan.plan.delays);
  EXPECT_LE(worst_use(reference, machine), 1.0 + 1e-6) << what;
  for (std::size_t b = 0; b + 1 < plan.path.blocks(); ++b) {
    ASSERT_LE(reference.error(plan.path, filter.order(), b), plan.path.tolerance[b] * (1.0 + 1e-9) + 1e-12)
        << what << " joint " << b;
  }
  EXPECT_EQ(static_cast<long>(reference.position.size()) - 1, plan.plan.simulation.samples) << what;
}

TEST(FeedSchedule, RandomProgramsHoldByPlainConvolution) {
  for (unsigned seed = 1; seed <= 12; ++seed) {
    const bool jerk = seed % 3 == 0;
    Machine machine = machine_within(0.2, 1.0 + seed % 4, jerk ? 50.0 : unlimited);
    if (seed % 4 == 1) {
      for (Axis& axis : machine.axes) {
        axis.mass = 30.0;
        axis.damping = 100.0;
        axis.force_max = 60.0;
        axis.power_max = 3.0;
        axis.regeneration_max = 2.0;
      }
    }
    const Toolpath path = path_of(random_program(seed, 250), machine);
    const Filter filter = jerk ? trapezoid(46, 20) : seed % 2 == 0 ? boxcar(17) : trapezoid(24, 6);
    expect_holds(schedule_feeds(path, filter, period, machine), filter, machine, "seed " + std::to_string(seed));
  }
}

TEST(FeedSchedule, ReversalsDoubledPointsAndTinyBlocksHold) {
  const Machine machine = machine_within(0.2, 1.0);
  std::string text = "G64 P0.02\nG1 F6000 X10\nX0\nX0\nX10 Y0.001\nX0 Y0.002\n";
  for (int i = 0; i < 60; ++i)
    text += "X" + std::to_string(0.003 * i) + " Y" + std::to_string(i % 2 == 0 ? 0.002 : 0.006) + "\n";
  text += "G61 X5 Y5\nX6\nG61.1 X7\nY8\nG64 P0.01\nG2 X17 Y8 R5\nG3 X7 Y8 R5\nG0 X100 Y100 Z-3\nG4 P0.05\nG1 X0 Y0\n";
  const Toolpath path = path_of(text, machine);
  for (const int order : {8, 17, 40})
    expect_holds(schedule_feeds(path, boxcar(order), period, machine), boxcar(order), machine,
                 "order " + std::to_string(order));
}

TEST(FeedSchedule, AStraightBlockStartsAndStopsAtTheWholeAcceleration) {
  // Steps of a tau every tau through a boxcar of tau are a constant acceleration: L/v + v/a in all, 20 divides 100.
  const Machine machine = machine_within(0.2, 1.0);
  const Toolpath path = path_of("G1 F6000 X100\n", machine);
  const ScheduledPlan plan = schedule_feeds(path, boxcar(19), period, program_machine(machine, path));
  ASSERT_TRUE(all_holds(plan.plan));
  // Half a sample in a million is given up at every step for rounding, and what is left over ends a sample.
  EXPECT_NEAR(static_cast<double>(plan.plan.simulation.samples), 1100.0, 1.0);
  EXPECT_EQ(plan.path.blocks(), 9U);  // 20 40 60 80 100 80 60 40 20 mm/s
}

TEST(FeedSchedule, AFeedBelowTheFirstStepIsKept) {
  const Machine machine = machine_within(0.2, 1.0);
  const Toolpath path = path_of("G1 F600 X10\n", machine);
  const ScheduledPlan plan = schedule_feeds(path, boxcar(19), period, program_machine(machine, path));
  EXPECT_EQ(plan.path.blocks(), 1U);
  EXPECT_EQ(plan.plan.simulation.samples, 1020);  // 1 s, and 20 taps
}

TEST(FeedSchedule, ACircleIsCutByItsFiltersVariance) {
  // Points v T apart on a circle of radius R, averaged over n taps, lie on R sin(n w/2)/(n sin(w/2)), w = v T/R.
  constexpr double radius = 5e-3, feed = 0.06;
  const Machine machine = machine_within(0.2, 1.0);
  LineSource source("test.ngc", "G64 P0.05\nG1 F3600 Y-10\nG3 X10 Y-10 I5 J0\nG3 X0 Y-10 I-5 J0\nG1 Y0\n");
  ToolpathOptions options;
  options.read.arc_tolerance = 1e-8;
  const Toolpath path = read_toolpath(source, machine, options);
  constexpr int n = 20;
  const ScheduledPlan plan = schedule_feeds(path, boxcar(n - 1), period, program_machine(machine, path));
  ASSERT_TRUE(all_holds(plan.plan));
  double error = 0.0;
  std::size_t seen = 0;
  for (std::size_t b = 0; b + 1 < plan.path.blocks(); ++b) {
    if (plan.path.inside_arc[b] == 0 || plan.path.line[b] != 3) continue;
    const double* p = plan.path.point(b);
    const double v = std::hypot(p[2] - p[0], p[3] - p[1]) / plan.path.duration[b];
    if (p[0] > 2e-3 && p[0] < 3e-3 && v > 0.999 * feed) error = plan.plan.errors[b], ++seen;
  }
  ASSERT_GT(seen, 0U);
  const double w = feed * period / radius;
  // Errors are distances from the path through the samples, which cuts each sample's arc by (v T)^2/(8 R); chords lie
  // within 1e-8 m.
  const double cut = feed * feed * period * period / (8.0 * radius) + 2e-8;
  EXPECT_NEAR(error, radius * (1.0 - std::sin(n * w / 2.0) / (n * std::sin(w / 2.0))), cut);
}

TEST(FeedSchedule, ShortBlocksAreNotBoundByTheTimeTheirFeedWouldTakeToReach) {
  // A staircase of 1.44 mm at 100 mm/s: at the programmed feed a filter of 100 samples would be needed.
  std::string text = "G64 P0.05\nG91 G1 F6000\n";
  for (int i = 0; i < 100; ++i) text += i % 2 == 0 ? "X1.44\n" : "Y1.44\n";
  const Machine machine = machine_within(0.2, 1.0);
  const Toolpath path = path_of(text, machine);
  const ScheduledPlan plan = schedule_feeds(path, boxcar(16), period, program_machine(machine, path));
  expect_holds(plan, boxcar(16), machine, "staircase");
  // Parabolic corners have v_c = sqrt(8 a e/(m n)) = 16.8 mm/s and take 16.8 ms, with constant acceleration between
  // them. So a block takes 2 (sqrt(v_c^2 + a L') - v_c)/a + 16.8 ms. L' is 1.44 mm less the corner's halves.
  const double corner = std::sqrt(8.0 * 1.0 * 50e-6 / std::sqrt(2.0)), left = 1.44e-3 - corner * corner;
  const double block = 2.0 * (std::sqrt(corner * corner + left) - corner) + corner;
  EXPECT_LT(static_cast<double>(plan.plan.simulation.samples) * period, 100.0 * block * 1.05 + 0.1);
}

TEST(FeedSchedule, CornersWaitWhereSlowingDownForTheWholeFilterTakesLonger) {
  // A staircase of 6 mm at 50 mm/s, or v, which the filter could start from rest at a sixth of the acceleration. A
  // corner without a delay keeps its feed for n = 50 samples, so v_c = 5.7 mm/s loses 44 samples (1 - v_c/v) n.
  std::string text = "G64 P0.05\nG91 G1 F3000\n";
  for (int i = 0; i < 100; ++i) text += i % 2 == 0 ? "X6\n" : "Y6\n";
  const Machine machine = machine_within(0.2, 6.0);
  const Toolpath path = path_of(text, machine);
  constexpr double n = 50.0, v = 0.05, tolerance = 50e-6;
  const ScheduledPlan plan = schedule_feeds(path, boxcar(49), period, program_machine(machine, path));
  expect_holds(plan, boxcar(49), machine, "long filter");
  // With a delay of d samples both legs are averaged for 2 m = n - d. The parabola between them is v T m^2/(sqrt(2) n)
  // from the corner. One sample more is left for rounding.
  const double m = std::sqrt(std::sqrt(2.0) * n * tolerance / (v * period)), delay = std::ceil(n - 2.0 * m) + 1.0;
  EXPECT_LT(delay, 36.0);
  EXPECT_LE(static_cast<double>(plan.plan.simulation.samples), 100.0 * (120.0 + delay) + n);
}

TEST(FeedSchedule, TheSearchFindsNothingSlowerThanAnyLengthOfTheGrid) {
  const Machine machine = machine_within(0.2, 1.0);
  const Toolpath path = path_of(random_program(3, 120), machine);
  const FilterSearch search = search_filter(path, period, machine, {});
  ASSERT_TRUE(search.filter);
  const auto samples = [&](const Filter& filter) {
    const ScheduledPlan plan = schedule_feeds(path, filter, period, machine);
    return all_holds(plan.plan) ? plan.plan.simulation.samples : INT64_MAX;
  };
  const auto found = samples(*search.filter);
  for (const int order : {7, 14, 21, 35, 50, 80}) EXPECT_LE(found, samples(boxcar(order)) * 102 / 100) << order;
}

// Without time the filter is a guess. Its one plan of chosen feeds is at least as fast as stops at every joint with any
// of these filters.
TEST(FeedSchedule, WithoutTimeTheFilterIsNoSlowerThanStopsWithTheBestOne) {
  Machine machine = machine_within(0.2, 1.0, 50.0);
  machine.axes.pop_back();  // the program has no Z
  std::mt19937 random(24);
  std::uniform_real_distribution<double> place(0.0, 50.0);
  std::string text = "G21 G90 F6000 G64 P0.01\n";
  for (int i = 0; i < 300; ++i) text += fmt::format("G1 X{:.3f} Y{:.3f}\n", place(random), place(random));
  const Toolpath path = path_of(text + "M2\n", machine);
  FilterSearchOptions options;
  options.time_limit = 1e-9;
  const FilterSearch search = search_filter(path, period, machine, options);
  ASSERT_TRUE(search.filter);
  const auto samples = [&](const Filter& filter) {
    const ScheduledPlan plan = stop_everywhere(path, filter, period, machine);
    return all_holds(plan.plan) ? plan.plan.simulation.samples : INT64_MAX;
  };
  const ScheduledPlan found = schedule_feeds(path, *search.filter, period, machine);
  ASSERT_TRUE(all_holds(found.plan));
  for (const int order : {40, 50, 60, 80, 100, 120, 150, 200})
    EXPECT_LE(found.plan.simulation.samples, samples(trapezoid(order, 20))) << order;
}

// Moves shorter than the filter: most plans hold after more rounds than judge most filters, and many never do.
TEST(FeedSchedule, TheSearchPrefersPlansThatHold) {
  Machine machine = machine_within(0.2, 1.0, 50.0);
  machine.axes.pop_back();  // the program has no Z
  std::mt19937 random(5);
  std::uniform_real_distribution<double> step(-0.5, 0.5);
  std::string text = "G21 G91 F6000 G64 P0.01\n";
  for (int i = 0; i < 60; ++i) text += fmt::format("G1 X{:.3f} Y{:.3f}\n", 0.5 + step(random), step(random));
  const Toolpath path = path_of(text + "M2\n", machine);
  const FilterSearch search = search_filter(path, period, machine, {});
  ASSERT_TRUE(search.filter);
  const auto plan = [&](const Filter& filter) { return schedule_feeds(path, filter, period, machine).plan; };
  const ProgramPlan found = plan(*search.filter);
  EXPECT_TRUE(all_holds(found));
  for (const int order : {20, 24, 28, 33, 40, 50}) {
    const ProgramPlan other = plan(trapezoid(order, 20 * order / 50));
    if (!all_holds(other)) continue;
    EXPECT_LE(found.simulation.samples, other.simulation.samples * 102 / 100) << order;
  }
}

// A corner that was met before has the answer that it has by itself, whichever of its properties differ from others'.
TEST(FeedCaps, ACornerDoesNotDependOnTheOnesBefore) {
  std::mt19937 random(5);
  const auto coin = [&random] { return random() % 2 == 0; };
  constexpr std::size_t blocks = 1500;
  std::string text = "G91 G64 P0.05\nF3000\n";
  for (std::size_t b = 0; b < blocks; ++b) text += b % 2 == 0 ? "G1 X1 Z1\n" : "G1 Y1\n";
  Toolpath path = path_of(text);
  FeedPath feeds{path.dimensions(), {}, {}, {}};
  std::vector<double> tolerance;
  for (std::size_t b = 0; b < blocks; ++b) {
    const double x = coin() ? 0.6 : 0.0;
    for (const double u : {x, x > 0.0 ? 0.8 : 1.0, 0.0}) feeds.direction.push_back(u);
    feeds.length.push_back(coin() ? 1e-3 : 2e-3);
    feeds.margin.push_back(coin() ? 1.0F : 0.75F);
    path.duration[b] = feeds.length[b] / (coin() ? 0.0625 : 0.03125);
    if (coin()) path.joint[b] = Joint::stop;
    tolerance.push_back(coin() ? 5e-5 : 1e-5);
  }
  const Machine machine = machine_within(0.2, 2.0, 100.0);
  const Filter filter = trapezoid(40, 10);
  const FilterBehind behind(filter, machine, period);
  const FeedWindow window(filter, machine, period, 3);
  FeedCaps caps(path, feeds, behind, window, period, 0.0);
  for (std::size_t b = 0; b + 1 < blocks; ++b) {
    const CornerFeed met = caps.corner(b, tolerance[b]);
    const CornerFeed alone = FeedCaps(path, feeds, behind, window, period, 0.0).corner(b, tolerance[b]);
    EXPECT_EQ(std::tie(met.speed, met.leaving, met.delay), std::tie(alone.speed, alone.leaving, alone.delay)) << b;
  }
}

TEST(JointDelays, DoNotDependOnTheOnesBefore) {
  std::mt19937 random(6);
  const auto coin = [&random] { return random() % 2 == 0; };
  constexpr std::size_t blocks = 1500;
  std::string text = "G91 G64 P0.05\nF3000\n";
  for (std::size_t b = 0; b < blocks; ++b) text += b % 2 == 0 ? "G1 X1\n" : "G1 Y1\n";
  Toolpath path = path_of(text);
  for (std::size_t b = 0; b < blocks; ++b) {
    // Powers of two, so that equal blocks have exactly the same velocities.
    path.points[2 * (b + 1)] = path.points[2 * b] + (coin() ? 0.0009765625 : 0.001953125);
    path.points[2 * (b + 1) + 1] = path.points[2 * b + 1] + (coin() ? 0.0 : coin() ? 0.0009765625 : -0.0009765625);
    path.duration[b] = coin() ? 0.03125 : 0.0625;
    if (coin()) path.joint[b] = Joint::stop;
    path.tolerance[b] = coin() ? 5e-5 : 1e-5;
  }
  const Machine machine = test::machine_of(2.0, 50.0);  // which some corners break at any delay
  const Filter filter = trapezoid(40, 10);
  JointDelays joints(path, filter, period, machine);
  int impossible = 0;
  for (std::size_t b = 0; b + 1 < blocks; ++b) {
    JointDelays alone(path, filter, period, machine);
    const auto delay = [&](JointDelays& of) {
      return path.joint[b] == Joint::stop ? of.stop(b) : of.corner(b, 1.0, 1.0);
    };
    EXPECT_EQ(delay(joints), delay(alone)) << b;
    const bool possible = alone.take_possible();
    EXPECT_EQ(joints.take_possible(), possible) << b;
    impossible += possible ? 0 : 1;
  }
  EXPECT_GT(impossible, 100);
  EXPECT_LT(impossible, 1400);
}

TEST(FeedWindow, FindsTheTwoAveragesOfATrapezoid) {
  EXPECT_EQ(moving_averages(boxcar(9)), (std::array<int, 2>{10, 1}));
  EXPECT_EQ(moving_averages(trapezoid(40, 10)), (std::array<int, 2>{31, 11}));
  EXPECT_EQ(moving_averages(Filter({1.0, 3.0, 1.0})), (std::array<int, 2>{0, 0}));
}

TEST(FeedWindow, BrakingAndSpeedingUpHaveTheirOwnPower) {
  Machine machine = machine_within(1.0, 100.0);
  machine.axes.resize(1);
  machine.axes[0].mass = 10.0;
  machine.axes[0].damping = 20.0;
  machine.axes[0].power_max = 5.0;
  machine.axes[0].regeneration_max = 2.0;
  const FeedWindow window(boxcar(9), machine, period, 1);
  // From 0.4 to 0.5 m/s within 10 ms, (m a + c v) v = 5 at v = 0.5 gives a = 0. From 0.5 down to 0.4, m a v = 2 gives
  // 0.4 m/s^2.
  EXPECT_NEAR(window.change(0, 0.5, 0.4, false), 0.0, 1e-12);
  EXPECT_NEAR(window.change(0, 0.4, 0.5, false), 0.4 * 0.01, 1e-7);
  EXPECT_NEAR(window.change(0, 0.5, 0.4, true), 0.4 * 0.01, 1e-7);
}

}  // namespace
}  // namespace accdec
