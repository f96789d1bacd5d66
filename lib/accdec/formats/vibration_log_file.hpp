#pragma once

#include <optional>
#include <string>
#include <vector>

#include <accdec/design/find_modes.hpp>
#include <accdec/design/vibration_log.hpp>
#include <accdec/task.hpp>

namespace accdec {

/// Reads a log of accelerations or positions: a table with a header, commas or blanks between its columns. One column
/// is the time (t or time in s, or t_ms, time_us ..). The others are accelerations (ax, a_x or accel_x, with or without
/// unit) or positions of axes (x_mm, y_um), which are differenced twice. The header may begin with #, as that of
/// Klipper's raw accelerometer data does: #time,accel_x,accel_y,accel_z. Samples are put on an even grid of times.
/// @throws InputError with line and column, and what is allowed
VibrationLog read_vibration_log(const std::string& path);

/// The cost of a bound on the modes found, for a task.
struct ModeCost {
  double residual = 0.0;       ///< bound of every mode, 0 .. 1
  std::optional<double> more;  ///< s, of the objective; none: no design was found
  bool proved = false;
};

/// The modes as [[mode]] tables of a task. The band is as wide as the frequency was found to change, at least 2 % to
/// either side. Remarks name the axis, the standard errors and what each bound costs. An uncertain mode is a remark.
std::string modes_to_toml(const std::vector<FoundMode>& modes, const VibrationLog& log,
                          const std::vector<ModeCost>& costs, double residual, const std::string& log_name);
/// Those without doubt, as modes of a machine.
std::vector<Mode> bounded_modes(const std::vector<FoundMode>& modes, double residual);

}  // namespace accdec
