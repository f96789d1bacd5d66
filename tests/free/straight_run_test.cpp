#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <accdec/bounds/any_motion_bound.hpp>
#include <accdec/plan/along/straight_run.hpp>
#include <accdec/plan/run/free_plan.hpp>
#include <accdec/plan/verify/verify_program_result.hpp>

#include "../program/reference.hpp"
#include "support/tries.hpp"
#include "without_clock.hpp"

namespace accdec::straight_run_test {
namespace {

constexpr double T = 1e-3;

/// Way in which a speed is reached from rest by a trapezoid of acceleration, and its time.
struct Ramp {
  double time, way;
};
Ramp ramp(double speed, double acceleration, double jerk) {
  const double peak = std::min(acceleration, std::sqrt(speed * jerk)), time = speed / peak + peak / jerk;
  return {time, 0.5 * speed * time};
}

/// s, of the fastest motion from rest to rest: the largest speed from which there is room to stop, by bisection.
double least_time(double length, double speed, double acceleration, double jerk) {
  double low = 0.0, high = speed;
  if (2.0 * ramp(speed, acceleration, jerk).way > length) {
    for (int i = 0; i < 200; ++i) {
      const double middle = 0.5 * (low + high);
      (2.0 * ramp(middle, acceleration, jerk).way > length ? high : low) = middle;
    }
    return 2.0 * ramp(low, acceleration, jerk).time;
  }
  const Ramp end = ramp(speed, acceleration, jerk);
  return 2.0 * end.time + (length - 2.0 * end.way) / speed;
}

struct Stops {
  std::string program;
  double time = 0.0;  ///< s, of its legs one by one
  int legs = 0;
};

/// Random legs in space, from stop to stop: some cut into blocks of one direction, some with a dwell behind them.
Stops stops(const Machine& machine, unsigned seed, double longest, int legs = 20) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  Stops result{"G21 G90 F6000\n"};
  std::array<double, 3> at{};
  for (int leg = 0; leg < legs; ++leg) {
    const double size = longest * std::pow(0.02, std::abs(unit(random)));
    std::array<double, 3> way{};
    double length = 0.0;
    for (double& w : way) length = std::hypot(length, w = std::round(1e5 * size * unit(random)) * 1e-8);
    if (leg % 5 == 0) way = {way[0], 0.0, 0.0}, length = std::abs(way[0]);
    if (length < 1e-5) continue;
    const int pieces = leg % 4 == 1 ? 4 : 1;
    for (int i = 1; i <= pieces; ++i) {
      const double part = static_cast<double>(i) / pieces;
      result.program +=
          fmt::format("{} G1 X{:.9f} Y{:.9f} Z{:.9f}\n", i == pieces ? "G61.1" : "G64 P0.01",
                      1e3 * (at[0] + part * way[0]), 1e3 * (at[1] + part * way[1]), 1e3 * (at[2] + part * way[2]));
    }
    double v = 0.1, a = unlimited, j = unlimited;
    for (std::size_t i = 0; i < 3; ++i) {
      at[i] += way[i];
      const Axis& axis = machine.axes[i];
      const double direction = std::abs(way[i]) / length;
      v = std::min(v, axis.velocity_max / direction);
      a = std::min(a, axis.acceleration_max / direction);
      j = std::min(j, axis.jerk_max / direction);
    }
    result.time += least_time(length, v, a, j);
    ++result.legs;
    if (leg % 7 != 3) continue;
    result.program += "G4 P0.03\n";
    result.time += 0.03;
  }
  result.program += "M2\n";
  return result;
}

/// @param told  what was said on the way
ProgramResult free_plan(const std::string& program, const Task& task, std::string& told) {
  return test::free_without_clock({"test", test::path_of(program, task.machine)}, task,
                                  [&](const std::string& line) { told += line + "\n"; });
}

Task random_task(unsigned i) {
  Task task;
  task.sample_period = T;
  task.machine = test::machine_of(1.0 + i % 3, i % 2 == 0 ? 50.0 : 20.0, 0.2, 3);
  task.machine.axes[1].acceleration_max *= 0.7;
  task.machine.axes[2].jerk_max *= 0.5;
  task.machine.axes[2].velocity_max = 0.1;
  return task;
}

// Ends of legs lie at whole samples, so each takes less than one more than its optimum.
TEST(StraightRuns, AreAsFastAsEveryLegByItself) {
  for (unsigned i = 0; i < unsigned{test_support::tries(8)}; ++i) {
    const Task task = random_task(i);
    const Stops legs = stops(task.machine, 3 + i, i % 4 < 2 ? 40.0 : 2.0);
    std::string told;
    const ProgramResult result = free_plan(legs.program, task, told);
    EXPECT_TRUE(result.verification.feasible) << result.message << legs.program;
    EXPECT_THAT(verify_program_result(result, task).reasons, testing::IsEmpty()) << legs.program;
    EXPECT_LE(result.cycle_time, legs.time * (1.0 + 1e-6) + legs.legs * T) << told << legs.program;
  }
}

// Few legs: the bound of every window takes far longer than the plan.
TEST(StraightRuns, AreNotFasterThanAnyMotion) {
  for (unsigned i = 0; i < unsigned{test_support::tries(2)}; ++i) {
    const Task task = random_task(i);
    const Stops legs = stops(task.machine, 3 + i, 2.0, 4);
    std::string told;
    const double time = free_plan(legs.program, task, told).cycle_time;
    const Toolpath path = test::path_of(legs.program, task.machine);
    EXPECT_GE(time, any_motion_bound(path, task.machine, T, {}, false).time) << legs.program;
  }
}

// Without a jerk limit the ramps are straight.
TEST(StraightRuns, AreTheOptimumWithoutJerkLimit) {
  Task task;
  task.sample_period = T;
  task.machine = test::machine_of(1.0, unlimited, 0.2, 3);
  const Stops legs = stops(task.machine, 7, 20.0);
  std::string told;
  const ProgramResult result = free_plan(legs.program, task, told);
  EXPECT_TRUE(result.verification.feasible) << result.message;
  EXPECT_LE(result.cycle_time, legs.time * (1.0 + 1e-6) + legs.legs * T) << told << legs.program;
}

// If the time ends before plan profiles holds, the legs follow the samples of one filter.
TEST(StraightRuns, AreTakenWhenTheTimeIsOver) {
  Task task;
  task.sample_period = T;
  task.machine = test::machine_of(1.0, 50.0, 0.2, 3);
  FilterSpec filter;
  filter.kind = Shape::trapezoid, filter.order = 100, filter.ramp = 20;
  task.filter = filter;
  ProgramFileOptions options;
  options.deadline = Deadline(1e-9);
  const Stops legs = stops(task.machine, 5, 40.0);
  std::string told;
  const ProgramFile file{"test", test::path_of(legs.program, task.machine)};
  const ProgramResult result =
      run_free_plan(file, task, options, [&](const std::string& line) { told += line + "\n"; });
  EXPECT_TRUE(result.verification.feasible) << result.message;
  EXPECT_THAT(verify_program_result(result, task).reasons, testing::IsEmpty());
  EXPECT_LE(result.cycle_time, legs.time * (1.0 + 1e-6) + legs.legs * T) << told << legs.program;
}

// One leg of every kind: full speed and acceleration; full acceleration; neither; full speed alone.
TEST(StraightRuns, HoldEveryLimitAtEverySample) {
  const Machine machine = test::machine_of(1.0, 50.0, 0.2, 3);
  for (const auto& [length, feed] : {std::pair{60.0, 6000.0}, {12.0, 9000.0}, {0.3, 6000.0}, {5.0, 500.0}}) {
    const Toolpath path = test::path_of(fmt::format("F{} G1 X{} Y{}\nM2\n", feed, length, 0.5 * length), machine);
    const FreePath free(path, machine, T);
    const auto run = straight_run(free, 0, 0);
    ASSERT_TRUE(run);
    const double whole = length * 1e-3 * std::hypot(1.0, 0.5), most = 1.0 / std::hypot(1.0, 0.5);
    const double least = least_time(whole, feed / 6e4, 1.0 / most, 50.0 / most);
    const std::size_t count = run->position.size() / 2;
    EXPECT_EQ(static_cast<double>(count), std::ceil(least * (1.0 + 1e-6) / T - 1e-6)) << length;
    std::vector<double> x(3, 0.0);
    for (std::size_t k = 0; k < count; ++k) x.push_back(run->position[2 * k]);
    x.insert(x.end(), 3, x.back());
    EXPECT_DOUBLE_EQ(x.back(), length * 1e-3);
    for (std::size_t k = 3; k < x.size(); ++k) {
      EXPECT_LE(std::abs(x[k] - x[k - 1]), feed / 6e4 * most * T + 1e-15);
      EXPECT_LE(std::abs(x[k] - 2.0 * x[k - 1] + x[k - 2]), 1.0 * T * T);
      EXPECT_LE(std::abs(x[k] - 3.0 * x[k - 1] + 3.0 * x[k - 2] - x[k - 3]), 50.0 * T * T * T);
    }
  }
}

TEST(StraightRuns, AreNoneWhereThePathTurnsOrNothingBoundsIt) {
  const Machine machine = test::machine_of(1.0, 50.0);
  const Toolpath corner = test::path_of("G64 P0.1 F6000 G1 X10\nY10\nM2\n", machine);
  EXPECT_FALSE(straight_run(FreePath(corner, machine, T), 0, 1));
  EXPECT_TRUE(straight_run(FreePath(corner, machine, T), 0, 0));
  Machine free = machine;
  for (Axis& axis : free.axes) axis.acceleration_max = unlimited;
  EXPECT_FALSE(straight_run(FreePath(corner, free, T), 0, 0));
}

}  // namespace
}  // namespace accdec::straight_run_test
