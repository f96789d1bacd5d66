#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <coin/ClpSimplex.hpp>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <accdec/plan/along/leg_program.hpp>
#include <accdec/plan/verify/verify_program_result.hpp>

#include "../program/reference.hpp"
#include "support/tries.hpp"
#include "without_clock.hpp"

namespace accdec::shortest_legs_test {
namespace {

constexpr double T = 1e-3, longer = 4e-3;  // s

/// The longest way from rest to rest in so many samples, m, by Clp: a linear program over the steps along a line.
/// @param part  of the direction, by axis  @param T  s, of a sample
double longest(const std::vector<Axis>& axes, const std::vector<double>& part, double feed, int count, double T) {
  std::vector<CoinBigIndex> start{0};
  std::vector<int> index;
  std::vector<double> value, high;
  const double unit = feed * T;  // of a step, m
  // Factors of the steps k, k - 1, k - 2; steps before and after are at rest.
  const auto row = [&](int k, const std::array<double, 3>& factors, double most) {
    std::map<int, double> sum;
    for (int i = 0; i < 3; ++i) {
      if (k - i >= 0 && k - i < count) sum[k - i] += factors[static_cast<std::size_t>(i)];
    }
    for (const auto& [column, factor] : sum) index.push_back(column), value.push_back(factor * unit);
    start.push_back(static_cast<CoinBigIndex>(index.size()));
    high.push_back(most);
  };
  double step = 1.0;
  for (std::size_t a = 0; a < axes.size(); ++a) {
    const double u = std::abs(part[a]);
    if (u == 0.0) continue;
    step = std::min(step, axes[a].velocity_max / (u * feed));
    for (int k = 0; k <= count + 1; ++k) {
      if (axes[a].jerk_max < unlimited) row(k, {u, -2.0 * u, u}, axes[a].jerk_max * T * T * T);
      if (k > count) continue;
      row(k, {u, -u, 0.0}, axes[a].acceleration_max * T * T);
      if (!(axes[a].force_max < unlimited)) continue;
      const double m = u * axes[a].mass, c = u * axes[a].damping * T;
      row(k, {m + c, -m, 0.0}, axes[a].force_max * T * T);
    }
  }
  std::vector<double> low, costs(static_cast<std::size_t>(count), -1.0), from(static_cast<std::size_t>(count), 0.0),
      to(static_cast<std::size_t>(count), step);
  for (double& most : high) {  // rows of size 1
    const auto r = static_cast<std::size_t>(&most - high.data());
    for (auto i = static_cast<std::size_t>(start[r]); i < static_cast<std::size_t>(start[r + 1]); ++i) value[i] /= most;
    most = 1.0;
    low.push_back(-1.0);
  }
  CoinPackedMatrix matrix(false, count, static_cast<int>(high.size()), static_cast<CoinBigIndex>(index.size()),
                          value.data(), index.data(), start.data(), nullptr);
  ClpSimplex lp;
  lp.setLogLevel(0);
  lp.loadProblem(matrix, from.data(), to.data(), costs.data(), low.data(), high.data());
  lp.primal();
  EXPECT_EQ(lp.status(), 0);
  return -lp.objectiveValue() * unit;
}

/// @param T  s, of a sample: longer ones make smaller programs
int fewest(const std::vector<Axis>& axes, const std::vector<double>& part, double feed, double length, double T) {
  int low = static_cast<int>(length / (feed * T)), more = 1;
  while (longest(axes, part, feed, low + more, T) < length) low += more, more *= 2;
  int high = low + more;
  while (high - low > 1) {
    const int middle = low + (high - low) / 2;
    (longest(axes, part, feed, middle, T) < length ? low : high) = middle;
  }
  return high;
}

/// Three averages of a step: that many samples of a motion which holds the limits. The jerk's ends do not overlap.
int fewest_of_averages(const Axis& axis, double feed, double length) {
  int best = 1 << 20;
  const int steps = static_cast<int>(std::ceil(length / (feed * T)));
  for (int n1 = std::max(steps, 1); n1 < steps + 300; ++n1) {
    for (int n2 = 1; n2 <= n1; ++n2) {
      if (length / (n1 * n2) > axis.acceleration_max * T * T) continue;
      const double n3 = std::ceil(length / (n1 * n2 * axis.jerk_max * T * T * T));
      if (n3 <= n2 && n3 + n2 <= n1) best = std::min(best, n1 + n2 + static_cast<int>(n3) - 2);
      break;
    }
  }
  return best;
}

ProgramResult free_plan(const std::string& program, const Task& task) {
  const ProgramFile file{"test", test::path_of(program, task.machine)};
  const ProgramResult result = test::free_without_clock(file, task);
  EXPECT_TRUE(result.verification.feasible) << result.message << program;
  EXPECT_THAT(verify_program_result(result, task).reasons, testing::IsEmpty()) << program;
  return result;
}

// The sample at the start is one more than the steps.
TEST(ShortestLegs, AreTheOptimumOfALinearProgramme) {
  constexpr double T = longer;
  for (const bool force : {false, true}) {
    Task task;
    task.sample_period = T;
    task.machine = test::machine_of(1.0, 50.0);
    task.machine.axes[1].velocity_max = 0.1;
    if (force) {
      task.machine.axes[0].mass = task.machine.axes[1].mass = 20.0;
      task.machine.axes[0].damping = task.machine.axes[1].damping = 200.0;
      task.machine.axes[0].force_max = 35.0, task.machine.axes[1].force_max = 12.0;
      task.machine.axes[1].jerk_max = unlimited;
    }
    for (const auto& [x, y] : {std::pair{0.01, 0.0}, {0.3, 0.1}, {5.0, 1.0}, {12.0, 0.0}, {1.0, 12.0}, {30.0, -7.0}}) {
      const std::string program = fmt::format("G21 G90 G61.1 F6000\nG1 X{} Y{}\nM2\n", x, y);
      const double length = std::hypot(x, y);
      const int least = fewest(task.machine.axes, {x / length, y / length}, 0.1, length * 1e-3 * (1.0 - 1e-7), T);
      EXPECT_NEAR(free_plan(program, task).cycle_time, (least + 1) * T, 1e-9) << program << force;
    }
  }
}

TEST(ShortestLegs, AreNoLongerThanThreeAverages) {
  Task task;
  task.sample_period = T;
  task.machine = test::machine_of(1.0, 50.0);
  for (const double length : {0.01, 0.1, 0.3, 2.0, 9.0, 20.0, 200.0}) {
    const std::string program = fmt::format("G21 G90 G61.1 F6000\nG1 X{}\nM2\n", length);
    const int averages = fewest_of_averages(task.machine.axes[0], 0.1, length * 1e-3);
    EXPECT_LE(free_plan(program, task).cycle_time, (averages + 1) * T + 1e-9) << length;
  }
}

// 50 mm at 100 mm/s take 0.5 s and a ramp of 0.1 s by each of the averages: 500 + 100 + 20 - 2 steps, at the limits.
TEST(ShortestLegs, OfRoundFiguresTakeWholeNumbersOfSamples) {
  Task task;
  task.sample_period = T;
  task.machine = test::machine_of(1.0, 50.0);
  for (const auto& [legs, time] : {std::pair{"G1 X50\n", 0.619}, {"G1 X50\nG1 Y50\nG1 X0\n", 1.855}}) {
    const ProgramResult result = free_plan(std::string("G21 G90 G61.1 F6000\n") + legs + "M2\n", task);
    EXPECT_STREQ(result.plan.name(), "free");
    EXPECT_NEAR(result.cycle_time, time, 1e-9);
  }
}

// The end of a leg that uses all of a limit does not bind another axis, whose friction rules the next leg.
TEST(ShortestLegs, OfOtherAxesFollowAtOnce) {
  constexpr double T = longer;
  Task task;
  task.sample_period = T;
  task.machine = test::machine_of(1.0, 50.0);
  Axis& y = task.machine.axes[1];
  y.velocity_max = 0.05, y.acceleration_max = 0.3, y.jerk_max = unlimited;
  y.mass = 20.0, y.damping = 200.0, y.force_max = 10.0;
  const int first = fewest(task.machine.axes, {1.0, 0.0}, 0.1, 0.05 * (1.0 - 1e-7), T);
  const int second = fewest(task.machine.axes, {0.0, 1.0}, 0.05, 0.03 * (1.0 - 1e-7), T);
  const ProgramResult result = free_plan("G21 G90 G61.1\nG1 X50 F6000\nG1 Y30 F3000\nM2\n", task);
  EXPECT_NEAR(result.cycle_time, (first + second + 1) * T, 1e-9);
}

// Legs after one another take at most as many samples more as their differences see of the leg before.
TEST(ShortestLegs, WithFrictionFollowOneAnother) {
  constexpr double T = longer;
  std::mt19937 random(9);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int i = 0; i < test_support::tries(4); ++i) {
    Task task;
    task.sample_period = T;
    task.machine = test::machine_of(1.0, i % 2 == 0 ? 50.0 : unlimited);
    for (Axis& axis : task.machine.axes) axis.mass = 20.0, axis.damping = 200.0, axis.force_max = 30.0;
    std::string program = "G21 G90 G61.1 F6000\n";
    int samples = 1, legs = 0;
    std::array<double, 2> at{};
    for (; legs < 6; ++legs) {
      const std::array<double, 2> to{std::round(1e4 * unit(random)) * 1e-3, std::round(1e4 * unit(random)) * 1e-3};
      const double x = to[0] - at[0], y = to[1] - at[1], length = std::hypot(x, y);
      program += fmt::format("G1 X{:.3f} Y{:.3f}\n", to[0], to[1]);
      samples += fewest(task.machine.axes, {x / length, y / length}, 0.1, length * 1e-3 * (1.0 - 1e-7), T);
      at = to;
    }
    const int seen = i % 2 == 0 ? 2 : 1;
    EXPECT_LE(free_plan(program + "M2\n", task).cycle_time, (samples + seen * (legs - 1)) * T + 1e-9) << program;
  }
}

// Runs with corners stay, and wait no longer than their differences see of a leg before them.
TEST(ShortestLegs, MixWithOtherRuns) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int i = 0; i < test_support::tries(6); ++i) {
    Task task;
    task.sample_period = T;
    task.machine = test::machine_of(1.0, i % 3 == 0 ? unlimited : 50.0);
    FilterSpec filter;
    filter.kind = Shape::trapezoid, filter.order = 100, filter.ramp = 20;
    task.filter = filter;
    std::string program = "G21 G90 F6000\n";
    for (int b = 0; b < 10; ++b) {
      program += unit(random) < 0.5 ? "G61.1\n" : "G64 P0.1\n";
      program += fmt::format("G1 X{:.3f} Y{:.3f}\n", 10.0 * unit(random), 10.0 * unit(random));
      if (unit(random) < 0.2) program += "G4 P0.02\n";
    }
    program += "M2\n";
    const ProgramFile file{"test", test::path_of(program, task.machine)};
    std::string told;
    const ProgramResult result =
        test::free_without_clock(file, task, [&](const std::string& line) { told += line + "\n"; });
    EXPECT_TRUE(result.verification.feasible) << result.message << program;
    EXPECT_THAT(verify_program_result(result, task).reasons, testing::IsEmpty()) << program;
    EXPECT_THAT(told, testing::Not(testing::HasSubstr("refused"))) << program;
  }
}

// At full speed one step stands for many: the leg is a ramp, that step, and a ramp.
TEST(ShortestLegs, OfAnyLengthTakeTheTimeOfTheirSpeedMore) {
  const Machine machine = test::machine_of(1.0, 50.0);
  const auto samples = [&](double length) {
    const Toolpath path = test::path_of(fmt::format("G21 G90 G61.1 F6000\nG1 X{}\nM2\n", length), machine);
    const FreePath free(path, machine, T);
    FreeSamples motion;
    motion.position = {0.0};
    const auto run = straight_run(free, 0, 0);
    motion.position.insert(motion.position.end(), run->position.begin(), run->position.end());
    return with_shortest_legs(free, motion, {}).count(1);
  };
  const std::size_t one = samples(30.0);
  EXPECT_EQ(samples(40.0), one + 100);
  EXPECT_EQ(samples(20030.0), one + 200'000);
}

}  // namespace
}  // namespace accdec::shortest_legs_test
