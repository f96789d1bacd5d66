#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include <accdec/files.hpp>
#include <accdec/formats/log_rows.hpp>

namespace accdec {

std::vector<LogField> log_fields(std::string_view line) {
  const bool commas = line.find(',') != std::string_view::npos;
  const std::string_view separators = commas ? "," : " \t;";
  std::vector<LogField> fields;
  for (std::size_t at = 0; at <= line.size();) {
    const std::size_t end = std::min(line.find_first_of(separators, at), line.size());
    std::string_view text = line.substr(at, end - at);
    const std::size_t first = text.find_first_not_of(" \t\r"), last = text.find_last_not_of(" \t\r");
    const long column = static_cast<long>(at + (first == std::string_view::npos ? 0 : first)) + 1;
    text = first == std::string_view::npos ? std::string_view{} : text.substr(first, last - first + 1);
    if (commas || !text.empty()) fields.push_back({text, column});
    at = end + 1;
  }
  return fields;
}

double log_number(const LogField& field, const std::string& file, long line) {
  double value = 0.0;
  const std::string_view text = field.text;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !(std::abs(value) <= 1e12))
    throw InputError(file, line, field.column, fmt::format("`{}` is no number from -1e12 to 1e12", text.substr(0, 40)));
  return value;
}

void require_columns(std::size_t fields, std::size_t columns, const std::string& file, long line) {
  if (fields != columns)
    throw InputError(file, line, 1, fmt::format("the row has {} values; the header has {} columns", fields, columns));
}

}  // namespace accdec
