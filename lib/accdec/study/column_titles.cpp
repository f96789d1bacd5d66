#include <algorithm>
#include <cstddef>

#include <fmt/format.h>

#include <accdec/files/units.hpp>
#include <accdec/study/column_titles.hpp>
#include <accdec/study/point_columns.hpp>

namespace accdec {
namespace {

std::string last_part(const std::string& column) {
  return column.substr(column.rfind('.') + 1);
}

bool all_alike(const std::vector<std::string>& columns) {
  return std::all_of(columns.begin(), columns.end(),
                     [&](const std::string& c) { return last_part(c) == last_part(columns.front()); });
}

}  // namespace

std::vector<std::string> curve_titles(const std::vector<std::string>& columns) {
  std::vector<std::string> titles;
  for (const std::string& column : columns) {
    const std::size_t dot = column.rfind('.');
    std::string title = study::computation_title(column.substr(0, dot));
    if (dot != std::string::npos && !all_alike(columns)) title += ": " + last_part(column);
    titles.push_back(std::move(title));
  }
  return titles;
}

std::string unit_of(const std::string& column) {
  if (const study::PointColumn* of_points = study::find_point_column(column)) return std::string(of_points->unit);
  const Unit* unit = unit_in_name(column);
  return unit == nullptr ? "" : std::string(unit->printed);
}

std::string axis_title(const std::string& column, const std::string& unit) {
  std::string name = column;
  if (const Unit* found = unit_in_name(column)) name.resize(column.size() - found->suffix.size());
  const std::size_t dot = name.rfind('.'), begin = dot == std::string::npos ? 0 : dot + 1;
  std::replace(name.begin() + static_cast<std::ptrdiff_t>(begin), name.end(), '_', ' ');
  if (begin > 0) name = fmt::format("{}: {}", name.substr(0, dot), name.substr(begin));
  return unit.empty() ? name : fmt::format("{} / {}", name, unit);
}

std::string unit_in(const std::string& column, const Study& study) {
  for (const study::Variation& v : study.points().variations()) {
    if (v.name == column && unit_of(column).empty()) return unit_of(v.keys.front());
  }
  return unit_of(column);
}

std::string axis_title(const std::vector<std::string>& columns, const Study& study) {
  if (columns.empty()) return "";
  return axis_title(all_alike(columns) && columns.size() > 1 ? last_part(columns.front()) : columns.front(),
                    unit_in(columns.front(), study));
}

}  // namespace accdec
