#include <cmath>
#include <complex>
#include <numbers>
#include <optional>
#include <sstream>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <accdec/filter.hpp>
#include <accdec/motion/circle.hpp>
#include <accdec/plan/command/choose_feeds.hpp>
#include <accdec/plan/feeds/arc_caps.hpp>
#include <accdec/plan/report/plan_facts.hpp>
#include <accdec/program.hpp>

#include "reference.hpp"

namespace accdec::arcs_test {
namespace {

using test::machine_of;
using test::period;
using test::Reference;

constexpr double pi = std::numbers::pi;

/// A line of 20 mm into a circle of `turns` and a line out of it, all tangential. @param radius  mm
std::string circle_program(double radius, int turns, double tolerance_mm, double rise = 0.0, double feed = 6000.0) {
  return fmt::format("G64 P{}\nG1 F{} X20\nG3 X20 Y0 I0 J{} P{} Z{}\nG1 X40\n", tolerance_mm, feed, radius, turns,
                     rise);
}

Toolpath path_of(const std::string& text, const Machine& machine, double arc_tolerance, bool widen = false) {
  LineSource source("test.ngc", text);
  ToolpathOptions options;
  options.read.arc_tolerance = arc_tolerance;
  options.clamp_feeds = true;
  options.widen_arcs = widen;
  return read_toolpath(source, machine, options);
}

FeedPath feed_path(const Toolpath& path) {
  FeedPath feeds;
  feeds.dimensions = path.dimensions();
  feeds.margin.assign(path.blocks(), 1.0F);
  for (std::size_t b = 0; b < path.blocks(); ++b) {
    double sum = 0.0;
    for (std::size_t a = 0; a < path.dimensions(); ++a) sum += std::pow(path.point(b + 1)[a] - path.point(b)[a], 2);
    feeds.length.push_back(std::sqrt(sum));
    for (std::size_t a = 0; a < path.dimensions(); ++a)
      feeds.direction.push_back((path.point(b + 1)[a] - path.point(b)[a]) / feeds.length.back());
  }
  return feeds;
}

struct Caps {
  double least = unlimited, most = 0.0;
  std::size_t inside = 0;
};
/// Over all joints that have one.
Caps caps_of(const Toolpath& path, const Filter& filter, const Machine& machine, double tolerance) {
  const FeedPath feeds = feed_path(path);
  const FeedWindow window(filter, program_machine(machine, path), period, path.dimensions());
  const FilterBehind behind(filter, machine, period);
  const ArcCaps arcs(path, feeds, behind, window, period);
  Caps caps;
  for (std::size_t b = 0; b + 1 < path.blocks(); ++b) {
    const auto v = arcs.speed(b, tolerance);
    if (!v) continue;
    ++caps.inside;
    caps.least = std::min(caps.least, *v);
    caps.most = std::max(caps.most, *v);
  }
  return caps;
}

/// Uses of acceleration and jerk by differences of a plain convolution of points of the true circle.
std::pair<double, double> uses_on_circle(const Filter& filter, double radius, double v, const Machine& machine) {
  const auto command = [&](long k) { return std::polar(radius, v / radius * period * static_cast<double>(k)); };
  const auto turn = static_cast<long>(std::ceil(2.0 * pi * radius / v / period));
  std::vector<std::complex<double>> at;
  for (long k = 0; k < turn + 4; ++k) {
    std::complex<double> sum = 0.0;
    for (int i = 0; i <= filter.order(); ++i) sum += filter.tap(i) * command(k - i);
    at.push_back(sum);
  }
  double acceleration = 0.0, jerk = 0.0;
  for (std::size_t k = 3; k < at.size(); ++k) {
    const auto second = (at[k] - 2.0 * at[k - 1] + at[k - 2]) / (period * period);
    const auto third = (at[k] - 3.0 * at[k - 1] + 3.0 * at[k - 2] - at[k - 3]) / (period * period * period);
    acceleration = std::max({acceleration, std::abs(second.real()), std::abs(second.imag())});
    jerk = std::max({jerk, std::abs(third.real()), std::abs(third.imag())});
  }
  return {acceleration / machine.axes[0].acceleration_max, jerk / machine.axes[0].jerk_max};
}

TEST(ArcCaps, AFullCircleUsesItsAxesWholly) {
  for (const double radius : {2e-3, 5e-3, 20e-3}) {
    for (const bool jerk : {false, true}) {
      const Machine machine = machine_of(1.0, jerk ? 20.0 : unlimited, 0.2, 3);
      const Filter filter = jerk ? trapezoid(28, 9) : boxcar(19);
      const Toolpath path = path_of(circle_program(1e3 * radius, 4, 5.0, 0.0, 12000.0), machine, 1e-7);
      const Caps caps = caps_of(path, filter, machine, unlimited);
      ASSERT_GT(caps.inside, 100U);
      // The least of all headings has a normal or tangent along an axis, and plain convolution sees it, too. The
      // window's share for rounding is 5e-6; samples meet the worst heading up to 1 - cos(v T/(2 R)).
      const auto [acceleration, third] = uses_on_circle(filter, radius, caps.least, machine);
      EXPECT_LE(std::max(acceleration, third), 1.0 + 1e-9) << radius << jerk;
      EXPECT_GE(std::max(acceleration, third), 0.999) << radius << jerk;
      // At 45 degrees both axes share: up to 2^(1/4) faster by acceleration, 2^(1/6) by jerk; less where the heading
      // turns far within the window.
      if (!jerk) {
        EXPECT_GT(caps.most, 1.05 * caps.least) << radius;
      }
      EXPECT_LT(caps.most, 1.20 * caps.least) << radius << jerk;
    }
  }
}

TEST(ArcCaps, WhateverTheChords) {
  const Machine machine = machine_of(1.0, unlimited, 0.2, 3);
  double before = 0.0;
  for (const double chords : {1e-5, 1e-6, 1e-7}) {
    const Caps caps = caps_of(path_of(circle_program(5.0, 4, 5.0), machine, chords), boxcar(19), machine, unlimited);
    EXPECT_NEAR(caps.least, before > 0.0 ? before : caps.least, 1e-3 * caps.least);
    before = caps.least;
  }
}

TEST(ArcCaps, TheRadiusErrorIsThatOfTheClosedForm) {
  const Machine machine = machine_of(100.0, unlimited, 0.2, 3);
  for (const double radius : {2e-3, 5e-3, 20e-3}) {
    const Filter filter = trapezoid(40, 10);
    constexpr double tolerance = 20e-6;
    const Caps caps =
        caps_of(path_of(circle_program(1e3 * radius, 4, 5.0, 0.0, 60000.0), machine, 1e-8), filter, machine, tolerance);
    ASSERT_GT(caps.inside, 100U);
    const CircleError error = circle_error(filter, radius, caps.least, period);
    // With the sagitta between samples (v T)^2/(8 R), and v^2 s^2/(2 R) for the somewhat smaller R (1 - |H|).
    const double cut = std::pow(caps.least * period, 2) / (8.0 * radius);
    EXPECT_LE(error.radius_error + cut, tolerance);
    EXPECT_GE(error.radius_error + cut, tolerance * (1.0 - tolerance / radius) - 2e-8);
  }
}

TEST(ArcCaps, OfAHelixThePlaneCounts) {
  const Machine machine = machine_of(1.0, unlimited, 0.2, 3);
  const Caps flat = caps_of(path_of(circle_program(5.0, 4, 5.0), machine, 1e-7), boxcar(19), machine, unlimited);
  const double rise = 40.0, share = 4.0 * 2.0 * pi * 5.0 / std::hypot(4.0 * 2.0 * pi * 5.0, rise);
  const Caps helix = caps_of(path_of(circle_program(5.0, 4, 5.0, rise), machine, 1e-7), boxcar(19), machine, unlimited);
  EXPECT_NEAR(helix.least * share, flat.least, 1e-3 * flat.least);
}

ScheduledPlan schedule(const std::string& text, const Machine& machine, const Filter& filter, bool widen) {
  const Toolpath path = path_of(text, machine, 1e-7, widen);
  return schedule_feeds(path, filter, period, program_machine(machine, path));
}

/// Largest distance of filtered samples from the programmed circle around (20, radius), by plain convolution, where the
/// filter sees the circle alone.
double radius_error(const ScheduledPlan& plan, const Filter& filter, double radius) {
  const Reference reference(plan.path, filter, period, plan.plan.delays);
  double worst = 0.0;
  const PathArc& arc = plan.path.arcs.at(0);
  const auto begin = static_cast<std::size_t>(reference.reached.at(arc.first - 1)) +
                     3 * static_cast<std::size_t>(filter.order()),
             end = static_cast<std::size_t>(reference.reached.at(arc.last)) -
                   2 * static_cast<std::size_t>(filter.order());
  EXPECT_LT(begin + 20, end);
  for (std::size_t k = begin; k < end; ++k) {
    const std::vector<double>& p = reference.position[k];
    worst = std::max(worst, std::abs(std::hypot(p[0] - 20e-3, p[1] - radius) - radius));
  }
  return worst;
}

TEST(CompensateArcs, TheRadiusErrorFallsToSecondOrder) {
  const Machine machine = machine_of(1.0, unlimited, 0.2, 3);
  for (const double radius : {2.0, 5.0, 20.0}) {
    for (const double rise : {0.0, 8.0}) {
      const Filter filter = boxcar(29);
      const std::string text = circle_program(radius, 3, 0.5, rise, 12000.0);
      const ScheduledPlan plain = schedule(text, machine, filter, false);
      const ScheduledPlan wide = schedule(text, machine, filter, true);
      ASSERT_TRUE(all_holds(plain.plan) && all_holds(wide.plan));
      const double r = 1e-3 * radius, e = radius_error(plain, filter, r), left = radius_error(wide, filter, r);
      // v^2 s^2/(2 R) at v^2/R = 1 m/s^2 .. sqrt(2) times that, s^2 = (30^2 - 1)/12 samples.
      EXPECT_GT(e, 0.9 * 0.5 * 75e-6) << radius;
      EXPECT_LT(e, 1.5 * 0.5 * 75e-6) << radius;
      // Second order: e^2/R, the change of speed with the heading within the filter, and chords of 0.1 um.
      EXPECT_LT(left, 0.12 * e + 2e-7) << radius << " " << rise;
      // This costs time. The path is longer by e/R, and no feed rises. A widening that begins and ends within the
      // filter takes up to 3 e/tau^2 of the acceleration, an eighth of v^2/R. That is (9/8)^(1/2) in time.
      const double longer = 1.0 + 1.5 * e / r;
      EXPECT_LE(static_cast<double>(wide.plan.simulation.samples),
                1.06 * longer * static_cast<double>(plain.plan.simulation.samples));
      for (std::size_t b = 0; b < wide.path.blocks(); ++b) {
        double way = 0.0;
        for (std::size_t a = 0; a < wide.path.dimensions(); ++a)
          way += std::pow(wide.path.point(b + 1)[a] - wide.path.point(b)[a], 2);
        ASSERT_LE(std::sqrt(way) / wide.path.duration[b], 0.2 * (1.0 + 1e-9)) << b;
      }
    }
  }
}

TEST(CompensateArcs, LimitsAndTolerancesHoldByPlainConvolution) {
  // Tangential arcs of both senses, a corner into an arc, a stop in the middle of one, a helix.
  const std::string text =
      "G64 P0.01\nG1 F6000 X10\nG3 X15 Y5 I0 J5\nG2 X20 Y10 I5 J0\nG1 X25\nG3 X25 Y20 I0 J5 Z1\nG1 X5\nG2 X9 Y20 I2 "
      "J0\n"
      "G61.1 G3 X15 Y20 I3 J0\nG64 P0.02\nG3 X9 Y20 I-3 J0\nG1 X0 Y0\n";
  for (const bool jerk : {false, true}) {
    const Machine machine = machine_of(1.0, jerk ? 50.0 : unlimited, 0.2, 3);
    const Filter filter = jerk ? trapezoid(46, 20) : boxcar(24);
    const ScheduledPlan plain = schedule(text, machine, filter, false);
    const ScheduledPlan wide = schedule(text, machine, filter, true);
    ASSERT_TRUE(all_holds(wide.plan));
    const Reference reference(wide.path, filter, period, wide.plan.delays);
    for (std::size_t b = 0; b + 1 < wide.path.blocks(); ++b) {
      ASSERT_LE(reference.error(wide.path, filter.order(), b), wide.path.tolerance[b] * (1.0 + 1e-9) + 1e-12) << b;
    }
    const auto at = [&](std::size_t k, std::size_t a) {
      return reference.position[std::min(k, reference.position.size() - 1)][a];
    };
    for (std::size_t k = 3; k < reference.position.size() + 3; ++k) {
      for (std::size_t a = 0; a < reference.n; ++a) {
        const double second = (at(k, a) - 2.0 * at(k - 1, a) + at(k - 2, a)) / (period * period);
        const double third = (at(k, a) - 3.0 * at(k - 1, a) + 3.0 * at(k - 2, a) - at(k - 3, a)) / std::pow(period, 3);
        ASSERT_LE(std::abs(second), 1.0 + 1e-6) << k;
        ASSERT_LE(std::abs(third), machine.axes[a].jerk_max * (1.0 + 1e-6)) << k;
      }
    }
    // If the filter's radius error bound the feed, making it good lets arcs be faster.
    EXPECT_LT(wide.plan.simulation.samples, plain.plan.simulation.samples) << jerk;
  }
}

TEST(CompensateArcs, WhatIsEmittedPlansToTheSameTime) {
  Task task;
  task.sample_period = period;
  task.machine = machine_of(1.0, unlimited, 0.2, 3);
  const Filter filter = boxcar(24);
  const std::string text = circle_program(5.0, 2, 0.01);
  const ProgramResult result =
      run_program({"test.ngc", path_of(text, task.machine, 1e-7, true), task, Feeds::choose}, filter);
  ASSERT_TRUE(result.verification.feasible);
  EXPECT_GT(largest_widening(result.plan.path), 5e-6);
  std::ostringstream out;
  emit_program(result, out);
  const std::string emitted = out.str();
  LineSource source("emitted.ngc", emitted);
  ToolpathOptions options;
  options.clamp_feeds = options.dwells_before_filter = true;
  Toolpath again = read_toolpath(source, task.machine, options);
  const ProgramResult second = run_program({"emitted.ngc", std::move(again), task, Feeds::choose}, filter);
  ASSERT_TRUE(second.verification.feasible);
  EXPECT_NEAR(static_cast<double>(second.check.samples), static_cast<double>(result.check.samples), 1.0);
}

// Between the ends of chords nothing holds a motion against the tolerance, so that chords must not be far from the arc.
TEST(Arcs, ChordsAreNoFartherFromTheArcThanAnEighthOfItsTolerance) {
  const Machine machine = machine_of(0.2, unlimited, 1.0, 2);
  const auto farthest = [&](const std::string& words, std::optional<double> error_max) {
    const std::string text = words + "G1 F2000 X1\nG2 X1 Y0 I10\nM2\n";
    LineSource source("test.ngc", text);
    ToolpathOptions options;
    options.read.arc_tolerance = 2e-6;
    options.error_max = error_max;
    const Toolpath path = read_toolpath(source, machine, options);
    double far = 0.0;
    for (std::size_t b = 1; b < path.blocks(); ++b) {
      const double *p = path.point(b), *q = path.point(b + 1);
      const double x = 0.5 * (p[0] + q[0]) - 11e-3, y = 0.5 * (p[1] + q[1]);
      far = std::max(far, 10e-3 - std::hypot(x, y));
    }
    return far;
  };
  EXPECT_LE(farthest("G64 P0.001\n", {}), 0.125e-6 + 1e-15);
  EXPECT_GE(farthest("G64 P0.001\n", {}), 0.11e-6);
  EXPECT_LE(farthest("", 1e-6), 0.125e-6 + 1e-15);
  // On the exact path a third of 2 um.
  EXPECT_LE(farthest("G61\n", {}), 2e-6 / 3.0 + 1e-15);
  EXPECT_GE(farthest("G61\n", {}), 0.6e-6);
  EXPECT_LE(farthest("G64 P0.05\n", {}), 2e-6 + 1e-15);
  EXPECT_GE(farthest("G64 P0.05\n", {}), 1.8e-6);
}

}  // namespace
}  // namespace accdec::arcs_test
