#include <algorithm>
#include <array>
#include <atomic>
#include <random>
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <accdec/plan/run/fastest_plan.hpp>
#include <accdec/plan/run/free_plan.hpp>
#include <accdec/plan/verify/verify_program_result.hpp>

#include "../program/reference.hpp"

namespace accdec {
namespace {

struct Named {
  std::string_view name, program;
};

constexpr std::array<Named, 4> programs{
    {{"Corner", "G64 P0.5 F6000\nG1 X20\nG1 X20 Y20\nM2\n"},
     {"Stops", "G61.1 F6000\nG1 X10\nG1 X10 Y5\nG4 P0.01\nG1 X0 Y5\nM2\n"},
     {"Arcs", "G64 P0.05 F6000\nG1 X5\nG2 X15 Y0 I5 J0\nG3 X25 Y0 I5 J0\nG1 X30\nM2\n"},
     {"Short", "G64 P0.2 F6000\nG1 X1 Y0.4\nG1 X2 Y0\nG1 X3 Y0.4\nG1 X4 Y0\nG1 X4 Y5\nG1 X3 Y6\nM2\n"}}};

/// A task whose filter is given, so that no search ends by the clock.
Task task_with(double jerk) {
  Task task;
  task.sample_period = 2e-3;
  task.machine = test::machine_of(1.0, jerk);
  FilterSpec filter;
  filter.kind = Shape::trapezoid, filter.order = 30, filter.ramp = 6;
  task.filter = filter;
  return task;
}

class NeverSlower : public testing::TestWithParam<Named> {};

// The deadline is a request to end, not a clock: it is over at the beginning, or comes at a step of plan free.
TEST_P(NeverSlower, WheneverTheTimeEnds) {
  constexpr int planned = 2, all_planned = 5;  // steps of plan free, from which on it has profiles, and all plans
  for (const double jerk : {unlimited, 40.0}) {
    const Task task = task_with(jerk);
    const ProgramFile file{"test", test::path_of(std::string(GetParam().program), task.machine)};
    const ProgramResult own = plan_profiles_of({file.name, file.path, task, Feeds::choose, {}});
    const ProgramResult fastest = run_fastest_plan(file, task, {}, {});
    for (int end = 0, steps = planned; end < steps && end < all_planned + 3; end = std::max(planned, end + 1)) {
      std::atomic<bool> asked = end == 0;
      ProgramFileOptions options;
      options.deadline.end_when(asked);
      const ProgramResult& least = end >= all_planned ? fastest : own;
      const double most = end > 0 ? least.cycle_time : run_fastest_plan(file, task, options, {}).cycle_time;
      steps = 1;
      options.free.progress = [&](const FreeProgress& /*progress*/) { asked = asked || ++steps > end; };
      const ProgramResult free = run_free_plan(file, task, options, {});
      ASSERT_TRUE(free.verification.feasible) << free.message;
      EXPECT_LE(free.cycle_time, most) << "ended at step " << end << ", jerk " << jerk;
      EXPECT_THAT(verify_program_result(free, task).reasons, testing::IsEmpty()) << end;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Programs, NeverSlower, testing::ValuesIn(programs),
                         [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace accdec
