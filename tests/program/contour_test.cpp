#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <accdec/filter.hpp>
#include <accdec/program.hpp>

#include "program_command.hpp"
#include "reference.hpp"

// Programs whose motion is bounded by its distance from the moves alone, and the feeds on arcs behind servos under such
// a bound.

namespace accdec {
namespace {

using test::ProgramCommand;
using testing::HasSubstr;
using testing::Not;

struct Planned {
  ProgramResult result;
  double contour;  ///< m, largest distance of points on the steps of the motion from the blocks
};

double from_blocks(const Toolpath& path, double x, double y) {
  double least = unlimited;
  for (std::size_t b = 0; b < path.blocks(); ++b) {
    const double *p = path.point(b), *q = path.point(b + 1);
    const double dx = q[0] - p[0], dy = q[1] - p[1];
    const double s = std::clamp(((x - p[0]) * dx + (y - p[1]) * dy) / (dx * dx + dy * dy), 0.0, 1.0);
    least = std::min(least, std::hypot(x - p[0] - s * dx, y - p[1] - s * dy));
  }
  return least;
}

Planned planned(const std::string& text, const Task& task, const Filter& filter, Feeds feeds, double chords) {
  LineSource source("part.ngc", text);
  ToolpathOptions reading;
  reading.contour_max = *task.program_contour_max;
  reading.read.arc_tolerance = chords;
  Planned done{run_program({"part", read_toolpath(source, task.machine, reading), task, feeds}, filter), 0.0};
  constexpr int parts = 4;
  Motion motion(done.result.plan, task.sample_period, true);
  Sample before, now;
  for (motion.next(before); motion.next(now); before = now) {
    for (int i = 1; i <= parts; ++i) {
      const double t = static_cast<double>(i) / parts;
      const double x = before.position[0] + t * (now.position[0] - before.position[0]);
      const double y = before.position[1] + t * (now.position[1] - before.position[1]);
      done.contour = std::max(done.contour, from_blocks(done.result.plan.path, x, y));
    }
  }
  return done;
}

Task task_of(double contour, double period) {
  Task task;
  task.sample_period = period;
  task.machine = test::machine_of(4.0, 600.0, 0.5, 2);
  task.program_contour_max = contour;
  return task;
}

/// Corners, an arc and chords without any tolerance: the contour is held, and used where it binds.
TEST(ProgramContour, BoundsAPathByItself) {
  constexpr const char* part =
      "F6000\nG1 X20\nY20\nG3 X10 Y30 I-10\nG1 X0\nX-0.6 Y29.8\nX-1.1 Y29.4\nX-1.4 Y28.9\nY5\nM2\n";
  for (const double gain : {unlimited, 250.0}) {
    for (const Feeds feeds : {Feeds::keep, Feeds::choose}) {
      SCOPED_TRACE(testing::Message() << gain << ", " << static_cast<int>(feeds));
      Task task = task_of(4e-5, 5e-4);
      for (Axis& axis : task.machine.axes) axis.servo_gain = gain;
      const Planned plan = planned(part, task, trapezoid(60, 16), feeds, 1e-6);
      ASSERT_TRUE(plan.result.verification.feasible) << plan.result.message;
      EXPECT_LE(plan.contour, 4e-5 * (1.0 + 1e-9) + 1e-12);
      EXPECT_GE(plan.contour, 0.95 * 4e-5);
      EXPECT_FALSE(plan.result.plan.path.tolerance[0] < unlimited);
      EXPECT_LT(plan.result.cycle_time, plan.result.cycle_time_exact_stop.value_or(unlimited));
    }
  }
}

/// |H| of a filter at w, rad/s: the sum of its taps turned.
double kept(const Filter& filter, double w, double period) {
  std::complex<double> sum = 0.0;
  for (int i = 0; i <= filter.order(); ++i) sum += filter.tap(i) * std::polar(1.0, -w * period * i);
  return std::abs(sum);
}

/// A circle passed at w is seen through 1/(1 + j w/Kv) of each axis. With gains that differ it becomes an ellipse,
/// whose radii are the singular values of both; with one gain a circle of radius R/sqrt(1 + (w/Kv)^2).
double radius_left(double w, double kx, double ky, double radius, double by_filter) {
  const double x = 1.0 / (1.0 + w * w / (kx * kx)), y = 1.0 / (1.0 + w * w / (ky * ky));  // |H|^2
  const double turned = 2.0 * (std::atan(w / kx) - std::atan(w / ky));                    // of Hx^2 against Hy^2
  const double apart = std::sqrt(std::max(0.0, x * x + y * y - 2.0 * x * y * std::cos(turned)));
  const double least = by_filter * std::sqrt(0.5 * (x + y - apart));
  const double most = by_filter * std::sqrt(0.5 * (x + y + apart));
  return radius * std::max(1.0 - least, most - 1.0);
}

/// The feed on an arc falls to that at which the filter and both servos follow it within the bound. Chords and a first
/// order in w cost less than a twentieth of it.
void expect_feed_on_arc(double kx, double ky, double radius, double bound) {
  const Filter filter = trapezoid(120, 40);
  Task task = task_of(bound, 2.5e-4);
  task.machine.axes[0].servo_gain = kx, task.machine.axes[1].servo_gain = ky;
  double low = 0.0, high = 100.0;
  for (int i = 0; i < 60; ++i) {
    const double w = 0.5 * (low + high);
    (radius_left(w, kx, ky, radius, kept(filter, w, task.sample_period)) <= bound ? low : high) = w;
  }
  const double fastest = low * radius, mm = 1e3 * radius;
  const std::string part =
      fmt::format("F{:.3f}\nG1 X20\nG3 X20 Y{:.6f} J{:.6f}\nG1 X0\nM2\n", 6e4 * 2.0 * fastest, 2.0 * mm, mm);
  for (const Feeds feeds : {Feeds::keep, Feeds::choose}) {
    SCOPED_TRACE(testing::Message() << kx << ", " << ky << ", " << static_cast<int>(feeds));
    const Planned plan = planned(part, task, filter, feeds, 2e-7);
    ASSERT_TRUE(plan.result.verification.feasible) << plan.result.message;
    EXPECT_LE(plan.contour, bound * (1.0 + 1e-9) + 1e-12);
    const Toolpath& path = plan.result.plan.path;
    double way = 0.0, time = 0.0;
    for (std::size_t b = 0; b < path.blocks(); ++b) {
      if (path.inside_arc[b] != 0) way += path.length(b), time += path.duration[b];
    }
    EXPECT_NEAR(way, std::numbers::pi * radius, 1e-3);
    EXPECT_LE(way / time, 1.005 * fastest);
    EXPECT_GE(way / time, 0.95 * fastest);
  }
}

TEST(ProgramContour, FeedsOnArcsFallToThoseThatTheServosFollow) {
  expect_feed_on_arc(80.0, 80.0, 10e-3, 6e-5);
  expect_feed_on_arc(200.0, 200.0, 25e-3, 2e-5);
  expect_feed_on_arc(120.0, 100.0, 15e-3, 5e-5);
}

TEST_F(ProgramCommand, AContourIsEnough) {
  std::string task = read("task.toml");
  task.replace(task.find("error_max_um = 20"), 17, "contour_max_um = 20");
  write("task.toml", task);
  write("part.ngc", "F6000\nG1 X30\nY20\nG3 X20 Y30 I-10\nG1 X0\nG4 P0.1\nX10 Y0\nM2\n");
  const auto done = run("program part.ngc --task task.toml --json r.json --figure program.svg");
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_THAT(done.out, HasSubstr("verified: every sample simulated, all bounds hold"));
  EXPECT_THAT(done.out, Not(HasSubstr("worst corners")));
  EXPECT_THAT(done.out, Not(HasSubstr("inf")));
  EXPECT_THAT(done.out, Not(HasSubstr("nan")));
  EXPECT_EQ(run("verify r.json").code, 0) << read("out") << read("err");
  write("task.toml", task.erase(task.find("[program]")));
  EXPECT_NE(run("program part.ngc --task task.toml").code, 0);
  EXPECT_THAT(read("err"), HasSubstr("the corner at the end of this move has no tolerance"));
}

}  // namespace
}  // namespace accdec
