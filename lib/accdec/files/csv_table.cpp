#include <accdec/files/csv_table.hpp>

namespace accdec {

std::string csv_field(const std::string& text) {
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
