#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include <accdec/design/design.hpp>
#include <accdec/task/task.hpp>

namespace accdec::study {

/// One line of a study's table. Members keep their order; numbers, strings, or null for what does not exist at this
/// point.
using Row = nlohmann::ordered_json;

/// What a study can compute for each point, by the names study files use. A name's columns are "NAME.status" and so on:
///   optimum      filter, order and delays designed (design_task)
///   boxcar .. exponential-zvd   the best of that family of filters under the same limits (best_baseline)
///   delays       the task's filter, smallest delays
///   given        the task's filter and delays (0 where it gives none), whatever they break, with their peaks
///   exact-stop   the task's filter, every corner with the least delay at which nothing overlaps and all limits hold
///   slow-down    the task's filter, no delay, feeds lowered at the corner (see slow_down.hpp)
/// "shapes" in a study file stands for all families.
std::vector<std::string_view> computations();

/// Whether a computation is of the task's own filter and so means nothing without [filter].
bool needs_filter(std::string_view computation);

/// A column of computations, by the last part of its name: "cycle_time_ms" of "optimum.cycle_time_ms".
struct PointColumn {
  std::string_view name;
  std::string_view unit;  ///< as figures show it; empty for words and pure numbers
  bool words = false;     ///< texts; else numbers (delays of several corners are a text of numbers)
};

/// The column that "optimum.cycle_time_ms" is of; null if no computation has it.
const PointColumn* find_point_column(std::string_view column);

/// Columns of one computation, each "NAME.column", in the order rows have them.
std::vector<std::string> columns_of(std::string_view computation);

/// Computes one name for a task into a row. Exceptions do not pass: they become status "error" and a message.
void compute_into(Row& row, const Task& task, std::string_view computation, const DesignOptions& options);

/// What went wrong, if every one of these computations ended with status "error" in a row (there is at least one); else
/// null.
Row error_of(const Row& row, const std::vector<std::string>& computations);

/// The standard shape of the least cycle time in a row ("boxcar"), all that tie joined by "=", or null if none holds.
Row best_shape_of(const Row& row);

}  // namespace accdec::study
