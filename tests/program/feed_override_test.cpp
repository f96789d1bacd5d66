#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <accdec/filter.hpp>
#include <accdec/plan/report/feed_override.hpp>
#include <accdec/plan/report/plan_facts.hpp>
#include <accdec/program.hpp>

#include "reference.hpp"

// Needs that a plan has of a control, and the plan at an overridden feed.

namespace accdec {
namespace {

using test::machine_of;
using test::path_of;
using test::period;

constexpr std::array<double, 3> factors{0.5, 0.8, 1.2};

/// The corner error of a right angle after a moving average of n samples, with longer legs. At sample k after
/// the corner's command, leg 1 has the sum of (i - k)/n over i > k steps left. Leg 2 has done the sum of (k - d - i)/n
/// over i < k - d steps.
double corner_error(int n, int d, double step_in, double step_out) {
  double best = 1e300;
  for (int k = 0; k < n + d; ++k) {
    const double left = std::max(0, n - 1 - k), done = std::max(0, k - d);
    best =
        std::min(best, std::hypot(step_in * left * (left + 1) / (2.0 * n), step_out * done * (done + 1) / (2.0 * n)));
  }
  return best;
}

// Legs of 30 and 60 mm at 100 mm/s take whole samples at every override, so that steps are the feed times T.
TEST(FeedOverride, OfARightAngleIsTheClosedForm) {
  constexpr int n = 24, d = 9;
  constexpr double v = 0.1, tolerance = 1e-4;
  const Toolpath path = path_of("G64 P0.1 F6000\nG1 X30\nG1 Y60\nM2\n");
  const Machine m = program_machine(machine_of(6.0, unlimited, 0.2, 3), path);
  const std::vector<FeedOverride> found = feed_overrides(path, boxcar(n - 1), period, m, {d, 0});
  ASSERT_EQ(found.size(), factors.size());
  for (std::size_t i = 0; i < factors.size(); ++i) {
    const double step = factors[i] * v * period, error = corner_error(n, d, step, step);
    EXPECT_EQ(found[i].factor, factors[i]);
    EXPECT_NEAR(found[i].worst_error, error, 1e-12) << i;
    EXPECT_NEAR(found[i].worst_utilisation, error / tolerance, 1e-8) << i;
    EXPECT_EQ(found[i].worst_line, 2u);
    EXPECT_EQ(found[i].limit, "acceleration x");
    EXPECT_NEAR(found[i].limit_utilisation, factors[i] * v / (n * period) / 6.0, 1e-9) << i;
  }
}

TEST(FeedOverride, LeavesRapidMovesAndDelaysAsTheyAre) {
  constexpr int n = 24, d = 9;
  constexpr double rapid = 0.2;
  const Machine limits = machine_of(unlimited, unlimited, rapid, 3);
  const Toolpath path = path_of("G64 P0.1 F6000\nG0 X30\nG1 Y60\nM2\n", limits);
  const std::vector<FeedOverride> found =
      feed_overrides(path, boxcar(n - 1), period, program_machine(limits, path), {d, 0});
  for (std::size_t i = 0; i < factors.size(); ++i) {
    EXPECT_NEAR(found[i].worst_error, corner_error(n, d, rapid * period, factors[i] * 0.1 * period), 1e-12) << i;
    EXPECT_EQ(found[i].limit, "velocity x");
    EXPECT_NEAR(found[i].limit_utilisation, 1.0, 1e-9);
  }
}

// Faster than programmed, a corner at its tolerance breaks it, and so does a limit that is fully used.
TEST(FeedOverride, SaysInWordsWhatItBreaks) {
  Task task;
  task.sample_period = period;
  task.machine = machine_of(1.0, unlimited, 0.5, 3);
  LineSource source("part.ngc", "G64 P0.05 F6000\nG1 X30\nG1 Y30\nM2\n");
  const Toolpath path = read_toolpath(source, task.machine, {});
  const ProgramResult result = run_program({"part.ngc", path, task}, boxcar(99));
  ASSERT_TRUE(result.verification.feasible) << result.message;
  ASSERT_GT(result.overrides[2].worst_utilisation, 1.0);
  const std::string text = program_summary(result);
  const std::size_t at = text.find("feed override 120 %");
  ASSERT_NE(at, std::string::npos) << text;
  EXPECT_NE(text.find("\n    breaks its tolerance and acceleration", at), std::string::npos) << text;
  EXPECT_EQ(text.substr(0, at).find("breaks"), std::string::npos) << text;
}

/// The largest use of an axis limit: differences of the samples, at rest before and after.
double limit_use(const test::Reference& motion, const Machine& m) {
  double most = 0.0;
  const auto at = [&](std::size_t k, std::size_t back, std::size_t a) {
    return motion.position[k - std::min(k, back)][a];
  };
  for (std::size_t k = 0; k < motion.position.size(); ++k) {
    for (std::size_t a = 0; a < motion.n; ++a) {
      const double p0 = at(k, 0, a), p1 = at(k, 1, a), p2 = at(k, 2, a), p3 = at(k, 3, a);
      most = std::max({most, std::abs(p0 - p1) / period / m.axes[a].velocity_max,
                       std::abs(p0 - 2.0 * p1 + p2) / (period * period) / m.axes[a].acceleration_max,
                       std::abs(p0 - 3.0 * p1 + 3.0 * p2 - p3) / std::pow(period, 3) / m.axes[a].jerk_max});
    }
  }
  return most;
}

TEST(FeedOverride, OfRandomProgramsIsThatOfPlainConvolution) {
  const Filter filter = trapezoid(30, 8);
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const Toolpath path = path_of(test::random_program(seed, 60));
    const Machine m = program_machine(machine_of(8.0, 2000.0, 0.2, 3), path);
    std::mt19937 random(seed);
    std::vector<int> delays(path.blocks(), 0);
    for (int& delay : delays) delay = random() % 3 == 0 ? static_cast<int>(random() % 20) : 0;
    delays.back() = 0;
    const std::vector<FeedOverride> found = feed_overrides(path, filter, period, m, delays);
    for (std::size_t i = 0; i < factors.size(); ++i) {
      Toolpath slower = path;
      for (std::size_t b = 0; b < path.blocks(); ++b)
        if (path.rapid[b] == 0) slower.duration[b] /= factors[i];
      const test::Reference motion(slower, filter, period, delays);
      double error = 0.0, use = 0.0;
      for (std::size_t b = 0; b + 1 < path.blocks(); ++b) {
        if (!(path.tolerance[b] < unlimited)) continue;
        const double own = motion.error(slower, filter.order(), b);
        error = std::max(error, own);
        if (path.tolerance[b] > 0.0) use = std::max(use, own / path.tolerance[b]);
      }
      EXPECT_NEAR(found[i].worst_error, error, 1e-10) << seed << " " << factors[i];
      EXPECT_NEAR(found[i].worst_utilisation, use, 1e-5 * use) << seed << " " << factors[i];
      const double limit = limit_use(motion, m);
      EXPECT_NEAR(found[i].limit_utilisation, limit, 1e-6 * limit) << seed << " " << factors[i];
    }
  }
}

// The emitted program shows what a control has to do: a line each step of the feed, a dwell each delay.
TEST(ControlNeeds, AreThoseOfTheEmittedProgram) {
  Task task;
  task.machine = machine_of(6.0, 500.0, 0.5, 3);
  const Filter filter = trapezoid(40, 10);
  const std::string text =
      "G64 P0.02 F25000\nG1 X30\nG1 Y60\nG61.1\nG1 X0\nG64 P0.02\nG1 Y80\nG2 X10 Y90 I10 J0\nG1 X50 F1000\nM2\n";
  for (const Feeds feeds : {Feeds::keep, Feeds::choose}) {
    const ProgramResult result = run_program({"a", path_of(text, task.machine), task, feeds}, filter);
    ASSERT_TRUE(result.verification.feasible) << result.message;
    std::ostringstream out;
    emit_program(result, out);
    std::istringstream lines(out.str());
    std::size_t moves = 0, delays = 0;
    for (std::string line; std::getline(lines, line);) {
      moves += line.starts_with("G1 ") || line.starts_with("G0 ") ? 1 : 0;
      delays += line.starts_with("G4 P") ? 1 : 0;
    }
    const std::size_t steps = moves - result.programmed_moves;
    EXPECT_EQ(steps > 0, feeds == Feeds::choose);
    std::vector<std::string> needs;
    if (steps > 0) needs.push_back(fmt::format("step its feed inside blocks ({} steps)", steps));
    needs.push_back("filter all axes alike (41 taps)");
    ASSERT_GT(delays, 0U);
    needs.push_back(fmt::format("delay the command at {} corners by whole samples, before the filter", delays));
    EXPECT_EQ(control_needs(result), needs);
  }
}

TEST(ControlNeeds, ExactStopsNeedNoDelayOfTheCommand) {
  Task task;
  task.machine = machine_of(6.0, 500.0, 0.5, 3);
  const ProgramResult result =
      run_program({"a", path_of("G61.1 F6000\nG1 X30\nG1 Y60\nG1 X0\nM2\n", task.machine), task}, trapezoid(40, 10));
  ASSERT_TRUE(result.verification.feasible) << result.message;
  EXPECT_EQ(control_needs(result), std::vector<std::string>{"filter all axes alike (41 taps)"});
}

}  // namespace
}  // namespace accdec
