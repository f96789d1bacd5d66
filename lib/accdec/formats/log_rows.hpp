#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

// Internal to the room: rows of logs, which other programs have written.

namespace accdec {

inline constexpr std::size_t log_size_max = std::size_t{256} << 20;

/// A field of a row, with its column counted from 1.
struct LogField {
  std::string_view text;
  long column = 1;
};

/// Fields between commas, or else between blanks, tabs or semicolons.
std::vector<LogField> log_fields(std::string_view line);

/// @throws InputError if the field is no number from -1e12 to 1e12
double log_number(const LogField& field, const std::string& file, long line);

/// @throws InputError if the row has another number of fields than the header
void require_columns(std::size_t fields, std::size_t columns, const std::string& file, long line);

/// Calls `row(text, line)` for every line that is not blank.
template <class Row>
void for_each_row(std::string_view text, const Row& row) {
  long line = 0;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view content = text.substr(at, end - at);
    at = end + 1;
    ++line;
    if (content.find_first_not_of(" \t\r") != std::string_view::npos) row(content, line);
  }
}

}  // namespace accdec
