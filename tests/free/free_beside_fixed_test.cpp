#include <cmath>
#include <random>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <accdec/plan/free/free_motion.hpp>
#include <accdec/plan/run/fixed_plan.hpp>
#include <accdec/plan/run/free_plan.hpp>
#include <accdec/plan/verify/verify_program_result.hpp>

#include "../program/reference.hpp"
#include "support/tries.hpp"

namespace accdec {
namespace {

constexpr double two_ms = 2e-3;

/// Blocks of one kind, without arcs.
std::string program_of(int kind, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::string text = fmt::format("G64 P{} F{}\n", seed % 2 == 0 ? 0.02 : 0.2, seed % 3 == 0 ? 3000 : 6000);
  double x = 0.0, y = 0.0, heading = 6.0 * unit(random);
  for (int b = 0; b < 14; ++b) {
    double length = 8.0 * unit(random) + 0.2;
    switch (kind) {
      case 0: heading += 6.0 * unit(random); break;                                        // any corner, long legs
      case 1: heading += 6.0 * unit(random), length *= 0.1; break;                         // short ones
      case 2: heading += b % 2 == 0 ? 1.5 : -1.5, length = b % 2 == 0 ? 6.0 : 0.4; break;  // a staircase
      case 3: heading += 0.5 * (unit(random) - 0.3), length = 0.3 + unit(random); break;   // a curve
      default: heading += 3.0, length = 5.0 + unit(random); break;                         // to and fro
    }
    if (b == 7 && seed % 4 == 0) text += "G4 P0.02\n";
    x += length * std::cos(heading), y += length * std::sin(heading);
    text += fmt::format("G1 X{:.4f} Y{:.4f}\n", x, y);
  }
  return text + "M2\n";
}

class FreeBesideFixed : public ::testing::TestWithParam<int> {};

TEST_P(FreeBesideFixed, IsNeverSlower) {
  for (unsigned seed = 1; seed <= unsigned{test_support::tries(4)}; ++seed) {
    Task task;
    task.sample_period = two_ms;
    task.machine = test::machine_of(1.0, seed % 2 == 0 ? 40.0 : unlimited);
    // Given, so that no search ends by the clock; good ones for short moves.
    FilterSpec filter;
    filter.kind = Shape::trapezoid, filter.order = seed % 4 < 2 ? 12 : 30, filter.ramp = 6;
    task.filter = filter;
    const std::string program = program_of(GetParam(), seed);
    const ProgramFile file{"test", test::path_of(program, task.machine)};
    const ProgramResult fixed = run_fixed_plan(file, task, {}, {});
    const ProgramResult free = run_free_plan(file, task, {}, {});
    ASSERT_TRUE(free.verification.feasible) << free.message << program;
    EXPECT_THAT(verify_program_result(free, task).reasons, testing::IsEmpty()) << program;
    ASSERT_TRUE(fixed.verification.feasible) << fixed.message << program;
    EXPECT_LE(free.cycle_time, fixed.cycle_time * (1.0 + 1e-12)) << program;
  }
}

// The page of `accdec explore` has it before plan free begins.
TEST(FreeBesideFixed, TakesThePlanThatIsKnown) {
  Task task;
  task.sample_period = two_ms;
  task.machine = test::machine_of(1.0, 40.0);
  const ProgramFile file{"test", test::path_of(program_of(0, 1), task.machine)};
  ProgramResult known = run_fixed_plan(file, task, {}, {});
  ASSERT_TRUE(known.verification.feasible) << known.message;
  known.cycle_time = 1e-3;  // faster than any motion: the answer shows where it came from
  const ProgramResult free = run_free_plan(file, task, {}, {}, known);
  EXPECT_EQ(free.cycle_time, 1e-3);
  EXPECT_STREQ(free.plan.name(), "fixed");
}

INSTANTIATE_TEST_SUITE_P(Kinds, FreeBesideFixed, ::testing::Range(0, 5));

// A filter made for short blocks is faster than any corner by itself; the free motion goes on from there.
TEST(FreeBesideFixed, BeginsWithTheSamplesOfTheFasterPlan) {
  const std::string program = program_of(3, 2);
  const Toolpath path = test::path_of(program);
  Task task;
  task.sample_period = two_ms;
  task.machine = test::machine_of(1.0, 40.0);
  const ProgramResult fixed = run_program({"test", path, task, Feeds::choose}, trapezoid(30, 8));
  ASSERT_TRUE(fixed.verification.feasible) << fixed.message;
  const auto samples = sampled(path, fixed.plan, two_ms);
  ASSERT_TRUE(samples);
  ASSERT_EQ(samples->passes.size() + 1, path.blocks());
  EXPECT_EQ(samples->count(2), static_cast<std::size_t>(fixed.check.samples) + 1);
  for (std::size_t j = 0; j < samples->passes.size(); ++j) {
    const double at = samples->passes[j], whole = std::floor(at);
    EXPECT_GE(at, j > 0 ? samples->passes[j - 1] : 0.0);
    double distance2 = 0.0;
    for (std::size_t a = 0; a < 2; ++a) {
      const double* const p = samples->position.data() + 2 * static_cast<std::size_t>(whole) + a;
      distance2 += std::pow(p[0] + (at - whole) * (p[2] - p[0]) - path.point(j + 1)[a], 2);
    }
    EXPECT_LE(std::sqrt(distance2), path.tolerance[j] * (1.0 + 1e-9)) << j;
  }
}

}  // namespace
}  // namespace accdec
