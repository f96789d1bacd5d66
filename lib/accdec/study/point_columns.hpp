#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <accdec/batch/row_numbers.hpp>
#include <accdec/design.hpp>
#include <accdec/task.hpp>

namespace accdec::study {

using batch::Row;

/// The computations that a study can make for each point, by the names used in study files. A name's columns are
/// "NAME.status" and so on:
///   optimum      filter, order and delays designed (design_task)
///   boxcar .. exponential-zvd   the best of that family of filters under the same limits (best_member)
///   delays       the task's filter, smallest delays
///   given        the task's filter and delays (0 where it gives none), whatever they break, with their peaks
///   exact-stop   the task's filter, every corner with the least delay at which nothing overlaps and all limits hold
///   slow-down    the task's filter, no delay, feeds lowered at the corner (see slow_down.hpp)
/// "shapes" in a study file stands for all families.
std::vector<std::string_view> computations();
/// A computation for people: "designed", a family's title; others by their names.
std::string computation_title(std::string_view computation);

/// Whether a computation uses the task's own filter and so needs [filter].
bool needs_filter(std::string_view computation);

/// A column of computations, by the last part of its name: "cycle_time_ms" of "optimum.cycle_time_ms".
struct PointColumn {
  std::string_view name;
  std::string_view unit;  ///< as figures show it; empty for words and pure numbers
  bool words = false;     ///< texts; else numbers (delays of several corners are a text of numbers)
};

/// The column of "optimum.cycle_time_ms"; null if no computation has it.
const PointColumn* find_point_column(std::string_view column);

/// Columns of one computation, each "NAME.column", in the order rows have them.
std::vector<std::string> columns_of(std::string_view computation);

/// Computes one name for a task into a row. Exceptions become status "error" and a message.
void compute_into(Row& row, const Task& task, std::string_view computation, const DesignOptions& options);

/// The error, if there is at least one computation and all ended with status "error" in a row; else null.
Row error_of(const Row& row, const std::vector<std::string>& computations);

/// The standard shape with the least cycle time in a row ("boxcar"). Ties are joined by "="; null if no shape holds the
/// limits.
Row best_shape_of(const Row& row);

}  // namespace accdec::study
