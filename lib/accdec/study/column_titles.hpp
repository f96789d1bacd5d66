#pragma once

#include <string>
#include <vector>

#include <accdec/study/study_file.hpp>

namespace accdec {

/// Columns as the title of an axis: "optimum.cycle_time_ms" becomes "optimum: cycle time / ms". For several columns it
/// is their common part after the dot, else the first column. A variation whose name has no unit takes that of its task
/// key.
std::string axis_title(const std::vector<std::string>& columns, const Study& study);
std::string axis_title(const std::string& column, const std::string& unit);
/// The names of curves beside each other: computations by their titles; with the rest of the column's name only where
/// the columns differ in it.
std::vector<std::string> curve_titles(const std::vector<std::string>& columns);
/// The unit of a computed column, else that of the suffix; "" if it has none.
std::string unit_of(const std::string& column);
/// As `unit_of`. A variation whose name has no unit takes the unit of its task key.
std::string unit_in(const std::string& column, const Study& study);

}  // namespace accdec
