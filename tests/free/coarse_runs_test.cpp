#include <gtest/gtest.h>

#include <accdec/bounds/any_motion_bound.hpp>
#include <accdec/plan/along/coarse_runs.hpp>
#include <accdec/plan/run/along_plan.hpp>
#include <accdec/plan/run/fastest_plan.hpp>
#include <accdec/plan/verify/verify_program_result.hpp>

#include "../program/reference.hpp"

namespace accdec {
namespace {

Task task_with(double jerk, double damping) {
  Task task;
  task.sample_period = 1e-3;
  task.machine = test::machine_of(1.0, jerk, 0.2, 3);
  for (Axis& axis : task.machine.axes) {
    if (damping == 0.0) continue;
    axis.mass = 2.0;
    axis.damping = damping;
    axis.force_max = 1.8;
  }
  return task;
}

const char* const some_stops =
    "G64 P0.1 F6000\nG1 X20\nY2\nX0\nY4\nG61.1\nX20\nG64 P0.2 F3000\nY6\nG4 P0.02\nX0\nY8\nX20 F6000\nY10\nX0\nM2\n";

/// Profiles of a program, and the same motion after control points were shortened.
struct Shortened {
  Shortened(const char* program, const Task& task)
      : path(test::path_of(program, task.machine)),
        profiles(plan_profiles_of({"test", path, task, Feeds::choose, {}})),
        machine(program_machine(task.machine, path)),
        tube(path, machine, task.sample_period),
        before(sampled(path, *profiles.plan.trajectory(), task.sample_period)),
        after(with_coarse_runs(tube, before, {}, {}, report)) {}
  FreeReport report;
  Toolpath path;
  ProgramResult profiles;
  Machine machine;
  FreePath tube;
  FreeSamples before, after;
};

// The check of results makes everything again from the samples. No motion is shorter than the bound.
TEST(CoarseRuns, HoldAndAreFaster) {
  for (const double jerk : {unlimited, 50.0}) {
    for (const double damping : {0.0, 5.0}) {
      const Task task = task_with(jerk, damping);
      const Shortened motion(some_stops, task);
      ASSERT_TRUE(motion.profiles.verification.feasible);
      ProgramResult result = with_samples(motion.profiles, motion.after);
      EXPECT_EQ(judge_free_motion(result, motion.machine), "") << jerk << " " << damping;
      EXPECT_LT(motion.after.position.size(), motion.before.position.size()) << jerk << " " << damping;
      EXPECT_GT(motion.report.programmes, 0);
      const Deadline deadline(60.0);
      EXPECT_GE(result.cycle_time,
                any_motion_bound(motion.path, motion.machine, task.sample_period, deadline, false).time);
    }
  }
}

// Points between control points 2 ms apart lie up to a T^2/8 = 0.87 um inside: no room within tolerances of 5 um.
TEST(CoarseRuns, NeedRoomWithinTolerances) {
  const Task task = task_with(50.0, 0.0);
  const Shortened motion("G64 P0.005 F6000\nG1 X20\nY2\nX0\nM2\n", task);
  EXPECT_EQ(motion.after.position, motion.before.position);
  EXPECT_EQ(motion.report.programmes, 0);
}

}  // namespace
}  // namespace accdec
