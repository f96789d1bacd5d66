#include <cstdlib>
#include <string_view>

#include <accdec/files/csv_table.hpp>

namespace accdec {
namespace {

/// Spreadsheets would compute it: it begins as a formula does and is no number.
bool looks_like_formula(const std::string& text) {
  if (text.empty() || std::string_view("=@+-\t\r").find(text.front()) == std::string_view::npos) return false;
  char* end = nullptr;
  std::strtod(text.c_str(), &end);
  return *end != '\0';
}

}  // namespace

std::string csv_field(const std::string& plain) {
  std::string text = (looks_like_formula(plain) ? "'" : "") + plain;
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string out(1, '"');
  for (const char c : text) {
    if (c == '"') out += c;
    out += c;
  }
  out += '"';
  return out;
}

std::string csv_table(const std::vector<std::string>& head, const std::vector<std::vector<std::string>>& rows) {
  std::string csv;
  const auto line = [&](const std::vector<std::string>& cells) {
    for (std::size_t i = 0; i < cells.size(); ++i) csv.append(i > 0 ? "," : "").append(csv_field(cells[i]));
    csv += '\n';
  };
  line(head);
  for (const auto& row : rows) line(row);
  return csv;
}

}  // namespace accdec
