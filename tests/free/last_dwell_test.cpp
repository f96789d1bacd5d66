#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <accdec/files.hpp>
#include <accdec/plan/verify/verify_program_result.hpp>

#include "../program/reference.hpp"
#include "support/temporary_folder.hpp"
#include "without_clock.hpp"

namespace accdec::last_dwell_test {
namespace {

constexpr double T = 4e-3;

ProgramResult free_plan(const std::string& program, const Task& task) {
  const TemporaryFolder folder;
  return test::free_without_clock(read_program_file(folder.write("part.ngc", program), task, {}, {}), task);
}

// The motion before a rest that ends the program does not see it: straight legs, windows, and a run along an arc.
TEST(LastDwell, AddsItsTimeToTheMotionWithoutIt) {
  for (const double jerk : {50.0, unlimited}) {
    Task task;
    task.sample_period = T;
    task.machine = test::machine_of(1.0, jerk);
    // Given, so that no search ends by the clock.
    FilterSpec filter;
    filter.kind = Shape::trapezoid, filter.order = 25, filter.ramp = 5;
    task.filter = filter;
    for (const std::string program :
         {"G61.1 F6000\nG1 X10 Y3\nG1 X10.1 Y3\nG1 X20 Y3\n", "G64 P0.1 F6000\nG1 X6\nG1 Y5\nG1 X0 Y6\nG1 Y9\n",
          "G64 P0.01 F6000\nG1 X10\nG3 X10 Y10 J5\n", "G61.1 F6000\nG3 X8 I4\n"}) {
      const ProgramResult without = free_plan(program + "M2\n", task);
      const ProgramResult with = free_plan(program + "G4 P0.0105\nM2\n", task);
      EXPECT_TRUE(with.verification.feasible) << with.message << program;
      EXPECT_THAT(verify_program_result(with, task).reasons, testing::IsEmpty()) << program;
      EXPECT_STREQ(with.plan.name(), without.plan.name()) << program;
      EXPECT_NEAR(with.cycle_time, without.cycle_time + 0.012, 1e-9) << program;
    }
  }
}

}  // namespace
}  // namespace accdec::last_dwell_test
