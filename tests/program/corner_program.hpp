#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include <accdec/task.hpp>

namespace accdec::test {

/// A program of corners for tests of controls, and the machine that runs it.
inline constexpr const char* corner_program =
    "G21 G90 G64 P0.05\nG1 X30 F3000\nY30\nX50 Y50\nX20\nX0 Y0\nX40 Y10\nX0 Y20\nX30 Y22\nM2\n";
inline constexpr const char* corner_machine =
    "sample_period_ms = 1.0\n[[axis]]\nvelocity_max_mm_s = 500\nacceleration_max_mm_s2 = 6000\n"
    "jerk_max_mm_s3 = 500000\n[program]\nerror_max_um = 20\n";

/// Averages of so many stages on two axes without a jerk limit, for a control with these delays.
inline Task averages_task(int stages, std::vector<DelayKind> delays) {
  Task task;
  task.sample_period = 1e-3;
  task.design.order_max = 26;
  for (const char* name : {"x", "y"}) {
    Axis axis;
    axis.name = name;
    axis.velocity_max = 0.2;
    axis.acceleration_max = 6.0;
    task.machine.axes.push_back(axis);
  }
  task.settings = ControllerSettings{};
  task.settings->families = {SettingFamily::averages};
  task.settings->stages.assign(static_cast<std::size_t>(stages), {});
  task.settings->delays = std::move(delays);
  return task;
}

}  // namespace accdec::test
