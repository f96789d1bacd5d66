#include <algorithm>
#include <cmath>
#include <sstream>
#include <vector>

#include <gtest/gtest.h>

#include <accdec/filter.hpp>
#include <accdec/plan/report/samples.hpp>
#include <accdec/program.hpp>
#include <accdec/simulate.hpp>

#include "reference.hpp"

// Peak and root mean square of the force over a program, against differences of all its positions.

namespace accdec {
namespace {

Task mill() {
  Task task;
  task.machine = test::machine_of(3.0, 400.0, 0.5, 3);
  for (Axis& axis : task.machine.axes) axis.mass = 34.0, axis.damping = 120.0, axis.force_max = 465.0;
  task.machine.axes[2].mass = task.machine.axes[2].damping = 0.0;
  task.machine.axes[2].force_max = unlimited;
  return task;
}

Toolpath path_of(const std::string& text, const Task& task) {
  LineSource source("part.ngc", text);
  return read_toolpath(source, task.machine, {});
}

void expect_loads(const ProgramResult& result, const Task& task) {
  ASSERT_TRUE(result.verification.feasible) << result.message;
  std::vector<std::vector<long double>> positions;
  const std::size_t axes = result.plan.path.dimensions();
  visit_samples(result, [&](std::int64_t, const double* x, const double*) { positions.emplace_back(x, x + axes); });
  ASSERT_EQ(static_cast<std::int64_t>(positions.size()), result.check.samples + 1);
  ASSERT_EQ(result.loads.size(), 2U);
  const long double T = result.sample_period;
  for (std::size_t a = 0; a < 2; ++a) {
    const Axis& axis = task.machine.axes[a];
    const auto x = [&](std::size_t k, std::size_t back) { return positions[k < back ? 0 : k - back][a]; };
    long double squares = 0.0L, peak = 0.0L;
    for (std::size_t k = 1; k < positions.size(); ++k) {
      const long double force =
          axis.mass * (x(k, 0) - 2 * x(k, 1) + x(k, 2)) / (T * T) + axis.damping * (x(k, 0) - x(k, 1)) / T;
      squares += force * force, peak = std::max(peak, std::abs(force));
    }
    EXPECT_EQ(result.loads[a].axis, result.plan.path.axis_name(a));
    EXPECT_NEAR(result.loads[a].peak, static_cast<double>(peak), 1e-5);
    EXPECT_NEAR(result.loads[a].rms, static_cast<double>(std::sqrt(squares / (positions.size() - 1))), 1e-5);
    for (const LimitUse& use : result.check.limits) {
      if (use.kind != LimitKind::force || use.axis != result.loads[a].axis) continue;
      EXPECT_NEAR(result.loads[a].peak, use.value, 1e-6 * use.value);
    }
  }
}

constexpr const char* legs =
    "G64 P0.02 F12000\nG1 X30\nG1 Y60\nG4 P0.3\nG1 X0\nG1 Y20 X-10\nG1 X40 F3000\nG1 X39 Y22 F3\nM2\n";

TEST(AxisLoads, OfAFilteredProgramAreThoseOfItsSamples) {
  const Task task = mill();
  expect_loads(run_program({"part.ngc", path_of(legs, task), task}, trapezoid(70, 20)), task);
  expect_loads(run_program({"part.ngc", path_of(legs, task), task, Feeds::choose}, trapezoid(70, 20)), task);
}

TEST(AxisLoads, OfATrajectoryAreThoseOfItsSamples) {
  const Task task = mill();
  expect_loads(run_profiles({"part.ngc", path_of(legs, task), task}), task);
}

/// Twice as long a dwell leaves the peak and lowers the mean.
TEST(AxisLoads, DwellsCoolTheDrive) {
  const Task task = mill();
  const auto loads = [&](const char* dwell) {
    const std::string text = std::string("F6000\nG1 X30\n") + dwell + "\nG1 X0\nM2\n";
    return run_program({"part.ngc", path_of(text, task), task}, trapezoid(70, 20));
  };
  const ProgramResult brief = loads("G4 P0.1"), longer = loads("G4 P2.1");
  EXPECT_NEAR(brief.loads[0].peak, longer.loads[0].peak, 1e-6);
  EXPECT_NEAR(longer.loads[0].rms / brief.loads[0].rms, std::sqrt(brief.cycle_time / longer.cycle_time), 1e-9);
}

}  // namespace
}  // namespace accdec
