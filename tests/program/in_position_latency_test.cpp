#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <accdec/design.hpp>
#include <accdec/plan/feeds/control_delay.hpp>
#include <accdec/plan/run/fixed_plan.hpp>
#include <accdec/plan/verify/verify_program_result.hpp>

#include "program_command.hpp"

// Programs of a control that takes time from within its in-position width to the next block.

namespace accdec {
namespace {

using test::Output;
using test::ProgramCommand;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr const char* two_legs = "G21 G90 G64\nG1 X30 F6000\nY30\nM2\n";

std::string control(const std::string& kinds, int latency) {
  return fmt::format(
      "sample_period_ms = 1\n[[axis]]\nacceleration_max_mm_s2 = 6000\n[design]\nfamily = \"averages\"\nstages = 2\n"
      "length_max_ms = 40\n[controller]\ndelays = [{}]\nin_position_latency_ms = {}\n[program]\nerror_max_um = 50\n",
      kinds, latency);
}

Task program_task(const std::string& kinds, int latency) {
  return parse_task(control(kinds, latency), "task", {.require_corners = false, .response = Considered::all});
}

ProgramResult planned_two_legs(const Task& task) {
  const TemporaryFolder folder;
  ProgramFileOptions options;
  options.fixed.feeds = Feeds::keep;
  ProgramFile file = read_program_file(folder.write("part.ngc", two_legs), task, options, {});
  return run_fixed_plan(file, task, options, {});
}

/// Legs of 300 samples at 100 mm/s. `design` has the latency by code of its own, and proves its settings.
TEST(InPositionLatency, AProgramOfOneCornerGetsWhatDesignProvesForIt) {
  for (const std::string kinds :
       {"\"in-position\"", "\"in-position\", \"exact-stop\"", "\"continuous\", \"in-position\""}) {
    for (const int latency : {0, 1, 3, 9, 30}) {
      SCOPED_TRACE(kinds + fmt::format(", {} ms", latency));
      const DesignResult proved = design_task(
          parse_task(control(kinds, latency) + "[[corner]]\nangle_deg = 90\nfeed_in_mm_min = 6000\nerror_max_um = 50\n",
                     "task", {.response = Considered::all}));
      ASSERT_EQ(proved.status, Status::optimal) << proved.message;
      const Task task = program_task(kinds, latency);
      const ProgramResult found = planned_two_legs(task);
      ASSERT_TRUE(found.verification.feasible) << found.message;
      EXPECT_NEAR(found.cycle_time, 0.6 + proved.cycle_time, 1e-9);
      EXPECT_THAT(verify_program_result(found, task).reasons, IsEmpty());
      if (found.settings->chosen.delays[0] == DelayKind::in_position) {
        EXPECT_GE(found.plan.command()->delays[0], latency);
      }
    }
  }
}

TEST(InPositionLatency, VerifyFindsDelaysThatTheControlCannotHave) {
  const Task task = program_task("\"in-position\"", 3);
  const ProgramResult found = planned_two_legs(task);
  ASSERT_TRUE(found.verification.feasible) << found.message;
  ASSERT_THAT(verify_program_result(found, task).reasons, IsEmpty());
  for (const int delay : {0, 1, 2}) {
    ProgramResult forged = found;
    std::get<FilteredCommand>(forged.plan.motion).delays[0] = delay;
    EXPECT_THAT(verify_program_result(forged, task).reasons,
                Contains(HasSubstr(fmt::format(
                    "a delay of {} samples is shorter than the control's in-position latency of 3 ms", delay))))
        << delay;
  }
  const std::string as_long = fmt::format("do not give a delay of {} samples", found.plan.command()->delays[0]);
  for (const int latency : {0, 2, 4}) {
    EXPECT_THAT(verify_program_result(found, program_task("\"in-position\"", latency)).reasons,
                Contains(HasSubstr(as_long)))
        << latency;
  }
}

/// The way left of averages of 18 and 12 samples at 100 mm/s is below 0.23 mm after 15 samples, not after 14.
TEST(InPositionLatency, IsPartOfEveryDelayByTheWidth) {
  const Filter filter = averages(std::vector<int>{18, 12});
  ControlDelays control{{DelayKind::continuous, DelayKind::in_position, DelayKind::exact_stop}, 0.23e-3};
  control.latency = 3;
  EXPECT_EQ(control_delay(control, filter, 1e-4, 0), 0);
  EXPECT_EQ(control_delay(control, filter, 1e-4, 1), 18);
  EXPECT_EQ(control_delay(control, filter, 1e-4, 18), 18);
  EXPECT_EQ(control_delay(control, filter, 1e-4, 19), 28);
  control.latency = 14;
  EXPECT_EQ(control_delay(control, filter, 1e-4, 1), 28) << "an exact stop is shorter";
  EXPECT_EQ(control_delay(control, filter, 1e-4, 29), 29);
  control.kinds = {DelayKind::in_position};
  EXPECT_EQ(control_delay(control, filter, 1e-4, 0), 29);
  control.width = 0.0;
  EXPECT_EQ(control_delay(control, filter, 1e-4, 0), std::nullopt) << "no motion is within no width";
}

TEST_F(ProgramCommand, AProgramRecordsAndVerifiesTheInPositionLatency) {
  write("part.ngc", two_legs);
  write("control.toml", control("\"in-position\"", 3));
  ASSERT_EQ(run("program part.ngc --task control.toml --json r.json --emit e.ngc").code, 0) << read("err");
  EXPECT_THAT(read("e.ngc"), HasSubstr("the next block starts 3 ms after the axes are within the in-position width"));
  EXPECT_EQ(run("verify r.json").code, 0) << read("out");
  std::string record = read("r.json");
  const std::string key = "in_position_latency_ms = 3";
  ASSERT_NE(record.find(key), std::string::npos);
  write("forged.json", record.replace(record.find(key), key.size(), "in_position_latency_ms = 4"));
  write("control.toml", control("\"in-position\"", 4));
  const Output forged = run("verify forged.json");
  EXPECT_EQ(forged.code, 1) << forged.err;
  EXPECT_THAT(forged.out, HasSubstr("do not give a delay of"));
}

}  // namespace
}  // namespace accdec
