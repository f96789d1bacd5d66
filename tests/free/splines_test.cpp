#include <gtest/gtest.h>

#include <accdec/bounds/any_motion_bound.hpp>
#include <accdec/plan/free/free_motion.hpp>
#include <accdec/plan/free/splines.hpp>
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

const char* const corners =
    "G64 P0.1 F6000\nG1 X20\nY2\nX0\nY4\nX20\nG64 P0.2\nY6\nX0\nY8\nX20\nY10\nX0\nY20\nX20\nY30\nX5 Y35\nX0\nM2\n";

/// Profiles of a program, as one part.
struct Begun {
  Begun(const char* program, const Task& task)
      : path(test::path_of(program, task.machine)),
        profiles(plan_profiles_of({"test", path, task, Feeds::choose, {}})),
        machine(program_machine(task.machine, path)),
        tube(path, machine, task.sample_period),
        motion(sampled(path, *profiles.plan.trajectory(), task.sample_period)),
        part{1, motion.count(path.dimensions()) - 1, 0, path.blocks() - 1} {
    for (const double pass : motion.passes) part.passes.push_back(pass - 1.0);
  }
  /// The motion with the part in it, checked.
  ProgramResult with(const ShortenedPart& made) const {
    const auto n = static_cast<std::ptrdiff_t>(path.dimensions());
    FreeSamples samples;
    samples.position.assign(motion.position.begin(), motion.position.begin() + n);
    samples.position.insert(samples.position.end(), made.position.begin(), made.position.end());
    samples.position.insert(samples.position.end(), motion.position.end() - n, motion.position.end());
    for (const double pass : made.passes) samples.passes.push_back(pass + 1.0);
    ProgramResult result = with_samples(profiles, samples);
    EXPECT_EQ(judge_trajectory(result, machine), "");
    return result;
  }

  Toolpath path;
  ProgramResult profiles;
  Machine machine;
  FreePath tube;
  FreeSamples motion;
  FreePart part;
};

// The check of results makes everything again from the samples. No motion is shorter than the bound.
TEST(Splines, HoldAndAreFaster) {
  for (const double jerk : {unlimited, 50.0}) {
    for (const double damping : {0.0, 5.0}) {
      const Task task = task_with(jerk, damping);
      const Begun begun(corners, task);
      ASSERT_TRUE(begun.profiles.verification.feasible);
      const double bound = any_motion_bound(begun.path, begun.machine, task.sample_period, Deadline(60.0), false).time;
      for (const std::size_t spacing : {2, 4}) {
        const SplineTube splines(begun.tube, spacing);
        ASSERT_TRUE(splines.has_room(begun.part));
        const ShortenedPart made = splines.shorten(begun.motion.position, begun.part, 120, [] { return false; });
        ASSERT_GT(made.saved, 0U) << jerk << " " << damping << " " << spacing;
        const ProgramResult result = begun.with(made);
        EXPECT_LT(result.cycle_time, begun.profiles.cycle_time);
        EXPECT_GE(result.cycle_time, bound);
      }
    }
  }
}

// Windows that were solved before the time ended are kept, and the old motion follows.
TEST(Splines, HoldWheneverTheyEnd) {
  const Begun begun(corners, task_with(50.0, 0.0));
  const SplineTube splines(begun.tube, 2);
  std::size_t least = 1;
  for (const int windows : {3, 6, 9}) {
    int left = windows;
    const ShortenedPart made = splines.shorten(begun.motion.position, begun.part, 120, [&] { return --left < 0; });
    ASSERT_GE(made.saved, least) << windows;
    least = made.saved;
    begun.with(made);
  }
}

// Points between control points 2 ms apart lie up to a T^2/8 = 0.87 um inside: no room within tolerances of 5 um.
TEST(Splines, NeedRoomWithinTolerances) {
  const Begun begun("G64 P0.005 F6000\nG1 X20\nY2\nX0\nM2\n", task_with(50.0, 0.0));
  EXPECT_FALSE(SplineTube(begun.tube, 2).has_room(begun.part));
}

}  // namespace
}  // namespace accdec
