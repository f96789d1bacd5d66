#pragma once

#include <string>
#include <string_view>

#include <accdec/files/errors.hpp>
#include <accdec/task/task.hpp>

namespace accdec {

/// What the place a task is read for asks of it.
struct TaskOptions {
  bool require_corners = true;   ///< false for tasks of whole programs
  bool require_choices = false;  ///< the filter and every corner's delay must be given: nothing is left to design
  /// Axes that a single [[axis]] table, or none, stands for when no corner says how many there are: 1 .. 9, named x, y,
  /// z, a, b, c, u, v, w in order.
  int axes = 2;
};

/// Reads a task file (TOML, see README): strict, for a misspelt limit that is silently ignored would break a machine.
/// Unknown keys, wrong types, values outside their range, contradictions within the file and numbers that are not
/// finite are errors.
///
/// One [[axis]] table applies to every axis; none means axes x, y without limits. A corner is given either by
/// angle_deg, heading_deg and turn in the plane of the first two axes, or by direction_in and direction_out, one number
/// an axis (1 to 9 axes).
/// @throws InputError at the position of the first thing wrong.
Task read_task(const std::string& path, const TaskOptions& options = {});
/// The same for text; `name` stands for the file in messages.
Task parse_task(std::string_view text, const std::string& name, const TaskOptions& options = {});

}  // namespace accdec
