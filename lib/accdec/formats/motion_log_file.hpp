#pragma once

#include <optional>
#include <string>

#include <accdec/design/identify.hpp>
#include <accdec/design/motion_log.hpp>

namespace accdec {

/// SI units of one of a column whose name has no unit; none: it is refused.
struct ColumnUnits {
  std::optional<double> time{}, position{};
};
/// @param text  the unit of times, a comma, that of positions: "s,mm"
/// @throws std::invalid_argument with the units allowed
ColumnUnits column_units(const std::string& text);

/// Reads a log of positions: a table with a header, commas or blanks between its columns. Lines that begin with # are
/// passed over. One column is the time (t_s, t_ms, t_us, or time_ ..), the others are axes with their unit (x_mm, y_um,
/// z_m, a_deg). A column without known unit is refused unless `units` has it. There must be a sample every sample
/// period, or whole numbers of them of which the first is taken: times may be off by a tenth of their step.
/// @param period  s
/// @throws InputError with line and column, and what is allowed
MotionLog read_motion_log(const std::string& path, double period, const ColumnUnits& units = {});

/// The filter identified, as a part of a task file: [filter], or [controller] prefilter_taps. Remarks say how it fits
/// and which others do.
std::string identified_to_toml(const Identification& found, const MotionLog& log, double period, bool prefilter,
                               const std::string& log_name);

}  // namespace accdec
