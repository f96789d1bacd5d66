#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <accdec/filter.hpp>
#include <accdec/program.hpp>

#include "program_command.hpp"
#include "reference.hpp"

// The control's own smoothing (`prefilter_taps`) behind the filter of a program.

namespace accdec {
namespace {

using test::ProgramCommand;
using testing::HasSubstr;

constexpr const char* part =
    "G21 G90 G64 P0.05 F3000\nG0 X5 Y5\nG1 X30\nY30\nG3 X20 Y40 I-10\nG1 X0 Y10\nG61.1\nG1 X3 Y3\nG64 P0.02\nX20\nM2\n";
const std::vector<double> spread{1.0 / 12.0, 5.0 / 12.0, 5.0 / 12.0, 1.0 / 12.0};

Task task_with(std::vector<double> smoothing) {
  Task task;
  task.sample_period = 1e-3;
  for (const char* name : {"x", "y"}) {
    Axis axis;
    axis.name = name;
    axis.velocity_max = 0.2;
    axis.acceleration_max = 2.0;
    axis.jerk_max = 200.0;
    task.machine.axes.push_back(axis);
  }
  task.machine.prefilter_taps = std::move(smoothing);
  return task;
}

std::vector<double> through(const std::vector<double>& first, const std::vector<double>& second) {
  std::vector<double> taps(first.size() + second.size() - 1, 0.0);
  for (std::size_t i = 0; i < first.size(); ++i) {
    for (std::size_t j = 0; j < second.size(); ++j) taps[i + j] += first[i] * second[j];
  }
  return taps;
}

/// A filter and a smoothing behind it are one filter: all limits and errors hold behind both.
void plan_as_one_filter(const Filter& set) {
  const std::vector<double> own(set.taps().begin(), set.taps().end());
  for (const Feeds feeds : {Feeds::keep, Feeds::choose}) {
    const Task with = task_with(spread), without = task_with({});
    const ProgramResult smoothed = run_program({"part", test::path_of(part, with.machine), with, feeds}, set);
    const ProgramResult one =
        run_program({"part", test::path_of(part, without.machine), without, feeds}, Filter(through(own, spread)));
    ASSERT_TRUE(smoothed.verification.feasible) << smoothed.message;
    EXPECT_EQ(smoothed.cycle_time, one.cycle_time);
    ASSERT_EQ(smoothed.errors.size(), one.errors.size());
    for (std::size_t b = 0; b < one.errors.size(); ++b) EXPECT_NEAR(smoothed.errors[b], one.errors[b], 1e-12);
    ASSERT_EQ(smoothed.check.limits.size(), one.check.limits.size());
    for (std::size_t i = 0; i < one.check.limits.size(); ++i)
      EXPECT_NEAR(smoothed.check.limits[i].utilisation, one.check.limits[i].utilisation, 1e-9);
    EXPECT_EQ(smoothed.plan.set().order(), set.order());
    EXPECT_EQ(smoothed.plan.filter().order(), set.order() + 3);
  }
}

TEST(Smoothing, PlansAsOneFilterOfBoth) {
  plan_as_one_filter(trapezoid(40, 10));
  // Smoothing lowers the jerk of these again and again.
  plan_as_one_filter(boxcar(40));
}

class SmoothingCommand : public ProgramCommand {
 protected:
  /// @param more  behind the keys of the axes
  void task(const std::string& more) {
    write("smooth.toml",
          "sample_period_ms = 1\n[[axis]]\nvelocity_max_mm_s = 200\nacceleration_max_mm_s2 = 2000\n"
          "jerk_max_mm_s3 = 200000\n[controller]\nprefilter_taps = [0.25, 0.25, 0.25, 0.25]\n" +
              more);
    write("part.ngc", part);
  }
};

/// Results and programs hold the taps that are set. Read back with the same task, the program takes as long.
TEST_F(SmoothingCommand, IsInEveryOutput) {
  task("");
  ASSERT_EQ(run("program part.ngc --task smooth.toml --json r.json --emit e.ngc --time-limit 10").code, 0)
      << read("err");
  const auto result = nlohmann::ordered_json::parse(read("r.json"));
  ASSERT_EQ(run("verify r.json").code, 0) << read("err") << read("out");
  ASSERT_EQ(run("export r.json --format csv --out taps.csv").code, 0) << read("err");
  EXPECT_THAT(read("e.ngc"), HasSubstr(fmt::format("filter of {} taps", result["filter"]["taps"].size())));
  ASSERT_EQ(run("program e.ngc --task smooth.toml --dwells-before-filter --json again.json").code, 0) << read("err");
  EXPECT_NEAR(number_of("again.json", "cycle_time_s"), number_of("r.json", "cycle_time_s"), 1.0001e-3);
  // Taps that are smoothed already would be smoothed twice.
  auto forged = result;
  forged["filter"]["taps"] = through(result["filter"]["taps"].get<std::vector<double>>(), std::vector(4, 0.25));
  forged["filter"]["order"] = forged["filter"]["taps"].size() - 1;
  write("forged.json", forged.dump());
  EXPECT_EQ(run("verify forged.json").code, 1) << read("out");
}

/// Settings of a control are chosen for the motion behind its smoothing.
TEST_F(SmoothingCommand, IsBehindSettings) {
  task("delays = [\"in-position\", \"exact-stop\"]\n[design]\nfamily = \"averages\"\nstages = 1\norder_max = 60\n");
  ASSERT_EQ(run("program part.ngc --task smooth.toml --json r.json --time-limit 20").code, 0) << read("err");
  ASSERT_EQ(run("verify r.json").code, 0) << read("err") << read("out");
}

/// Samples of these plans go to the drives as they are, so there is nothing that the smoothing is behind.
TEST_F(SmoothingCommand, OfPlansThatGiveSamplesIsRefused) {
  task("");
  for (const char* plan : {"profiles", "free"}) {
    EXPECT_EQ(run(fmt::format("program part.ngc --task smooth.toml --plan {} --samples s.csv", plan)).code, 2);
    EXPECT_THAT(read("err"), HasSubstr("does not consider the control's prefilter_taps"));
  }
}

}  // namespace
}  // namespace accdec
