#pragma once

#include <string>
#include <vector>

#include <accdec/study/study_file.hpp>

namespace accdec {

/// Columns as the title of an axis: "optimum.cycle_time_ms" becomes "optimum: cycle time / ms"; of several, what they
/// have in common after the dot, else the first. A variation whose name has no unit takes that of its task key.
std::string axis_title(const std::vector<std::string>& columns, const Study& study);
std::string axis_title(const std::string& column, const std::string& unit);
/// Of a computed column its own, else by the suffix; "" if it has none.
std::string unit_of(const std::string& column);
/// As `unit_of`; of a variation whose name has no unit that of its task key.
std::string unit_in(const std::string& column, const Study& study);

}  // namespace accdec
