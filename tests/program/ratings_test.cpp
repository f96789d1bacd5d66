#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <accdec/filter.hpp>
#include <accdec/plan/report/samples.hpp>
#include <accdec/plan/run/free_plan.hpp>
#include <accdec/plan/verify/verify_program_result.hpp>
#include <accdec/program.hpp>

#include "reference.hpp"

// Feeds and accelerations that a drive's rating lowers: against sweeps of lower ones.

namespace accdec {
namespace {

Task rubbing_task() {
  Task task;
  task.machine = test::machine_of(3.0, 400.0, 0.5, 2);
  for (Axis& axis : task.machine.axes) axis.mass = 34.0, axis.damping = 120.0, axis.coulomb = 40.0;
  return task;
}

Toolpath part_of(const Machine& machine, double all, double across) {
  const std::string text = fmt::format("G21 G90 G64 P0.1\nG1 X30 Y10 F{}\nY-40 F{}\nX0 F{}\nY0 F{}\nM2\n", all * 6000.0,
                                       all * across * 6000.0, all * 6000.0, all * across * 6000.0);
  LineSource source("part.ngc", text);
  return read_toolpath(source, machine, {});
}

ProgramResult planned(const Task& task, double all, double across, Feeds feeds) {
  return run_program({"part.ngc", part_of(task.machine, all, across), task, feeds}, trapezoid(70, 20));
}

/// Root mean square of the force of x, by differences of its positions.
double rms_of_x(const ProgramResult& result, const Axis& axis) {
  std::vector<long double> x;
  visit_samples(result, [&](std::int64_t, const double* p, const double*) { x.push_back(p[0]); });
  const long double T = result.sample_period;
  long double squares = 0.0L, before = 0.0L;
  for (std::size_t k = 1; k < x.size(); ++k) {
    const long double v = (x[k] - x[k - 1]) / T, moving = axis.mass * (v - before) / T + axis.damping * v;
    const bool stands = std::abs(v) < 1e-9L;
    const long double dry = stands ? std::clamp<long double>(-moving, -axis.coulomb, axis.coulomb)
                                   : std::copysign<long double>(axis.coulomb, v);
    squares += (moving + dry) * (moving + dry), before = v;
  }
  return static_cast<double>(std::sqrt(squares / static_cast<long double>(result.check.samples)));
}

/// Friction of x is above its rating, so that slower moves of x may heat it, and slower moves of y alone cool it. The
/// plan is no slower than the fastest of a sweep over both that is cool enough.
TEST(ProgramRatings, LowerFeedsNoMoreThanASweepOfThem) {
  const Task free = rubbing_task();
  for (const Feeds feeds : {Feeds::keep, Feeds::choose}) {
    for (const double part : {0.95, 0.8}) {
      Task task = free;
      const Axis& x = free.machine.axes[0];
      const double rating = task.machine.axes[0].force_rms_max = part * rms_of_x(planned(free, 1.0, 1.0, feeds), x);
      const ProgramResult cool = planned(task, 1.0, 1.0, feeds);
      ASSERT_TRUE(cool.verification.feasible) << cool.message;
      EXPECT_LE(rms_of_x(cool, x), rating * (1.0 + 1e-9));
      EXPECT_GE(rms_of_x(cool, x), 0.98 * rating);
      double best = unlimited;
      for (double all = 1.0; all > 0.3; all -= 0.05) {
        for (double across = 1.0; across > 0.3; across -= 0.02) {
          const ProgramResult slower = planned(free, all, across, feeds);
          if (slower.verification.feasible && rms_of_x(slower, x) <= rating) best = std::min(best, slower.cycle_time);
        }
      }
      EXPECT_LE(cool.cycle_time, best) << part << " of what it had";
    }
  }
}

ProgramResult profiles(const Task& task, double feed) {
  return run_profiles({"part.ngc", part_of(task.machine, feed, 1.0), task});
}

/// With and without a jerk limit. The sweep is over the feed of all lines and the acceleration of both axes. The plan
/// is within 1 % of the best of it, and uses nearly all of the rating.
TEST(ProgramRatings, LowerFeedsAndAccelerationsOfProfiles) {
  for (const double jerk : {unlimited, 50.0}) {
    Task free = rubbing_task();
    for (Axis& axis : free.machine.axes) axis.jerk_max = jerk, axis.coulomb = 0.0;
    const Axis& x = free.machine.axes[0];
    const ProgramResult warm = profiles(free, 1.0);
    for (const double part : {0.9, 0.6}) {
      Task task = free;
      const double rating = task.machine.axes[0].force_rms_max = part * rms_of_x(warm, x);
      const ProgramResult cool = profiles(task, 1.0);
      ASSERT_TRUE(cool.verification.feasible) << cool.message;
      EXPECT_STREQ(cool.plan.name(), "profiles");
      EXPECT_LE(rms_of_x(cool, x), rating * (1.0 + 1e-9));
      EXPECT_GE(rms_of_x(cool, x), 0.98 * rating);
      EXPECT_GT(cool.cycle_time, warm.cycle_time);
      double best = unlimited;
      for (double feed = 1.0; feed > 0.3; feed -= 0.05) {
        for (double ramps = 1.0; ramps > 0.1; ramps *= 0.95) {
          Task slower = free;
          for (Axis& axis : slower.machine.axes) axis.acceleration_max *= ramps;
          const ProgramResult slow = profiles(slower, feed);
          if (slow.verification.feasible && rms_of_x(slow, x) <= rating) best = std::min(best, slow.cycle_time);
        }
      }
      EXPECT_LE(cool.cycle_time, 1.01 * best) << part << " of what it had, jerk " << jerk;
    }
  }
}

/// A free motion is no slower than the profiles that it begins with, and as cool.
TEST(ProgramRatings, HoldInFreeMotions) {
  Task task = rubbing_task();
  for (Axis& axis : task.machine.axes) axis.coulomb = 0.0;
  const Axis x = task.machine.axes[0];
  task.machine.axes[0].force_rms_max = 0.8 * rms_of_x(profiles(task, 1.0), x);
  ProgramFileOptions options;
  options.free.sweeps = 1;
  const ProgramFile file{"part.ngc", part_of(task.machine, 1.0, 1.0)};
  const ProgramResult free = run_free_plan(file, task, options, {}), begun = profiles(task, 1.0);
  ASSERT_TRUE(free.verification.feasible) << free.message;
  EXPECT_LE(rms_of_x(free, x), task.machine.axes[0].force_rms_max * (1.0 + 1e-9));
  EXPECT_LE(free.cycle_time, begun.cycle_time);
  const ProgramResultCheck check = verify_program_result(free, task);
  EXPECT_TRUE(check.accepted) << fmt::format("{}", fmt::join(check.reasons, "; "));
}

}  // namespace
}  // namespace accdec
