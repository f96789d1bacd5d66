#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include <accdec/gcode/number.hpp>
#include <accdec/gcode/read_error.hpp>
#include <accdec/gcode/tool_parameters.hpp>

namespace accdec {
namespace {

constexpr double number_of_tool = 5400.0, first_of_tool = 5401.0, last_of_tool = 5413.0;

/// A line as rs274 sees it, without blanks and comments, and the column of every character.
struct Line {
  std::string text;
  std::vector<std::size_t> column;
};

Line without_blanks(std::string_view line) {
  Line kept;
  bool comment = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == ';' && !comment) break;
    if (line[i] == '(') comment = true;
    const bool blank = std::isspace(static_cast<unsigned char>(line[i])) != 0;
    if (!comment && !blank) kept.text += line[i], kept.column.push_back(i + 1);
    if (line[i] == ')') comment = false;
  }
  return kept;
}

struct Place {
  std::int64_t line;
  std::size_t column;
};

class Search {
 public:
  void look(std::string_view text, std::int64_t number) {
    const Line line = without_blanks(text);
    const std::string& s = line.text;
    if (s.empty() || s[0] == '/') return;  // deleted
    for (std::size_t i = 0; i < s.size(); ++i) {
      if (s[i] == '<') i = std::min(s.find('>', i), s.size() - 1);  // a name may hold digits
      indirect_ = indirect_ || (s[i] == '#' && i + 1 < s.size() && (s[i + 1] == '#' || s[i + 1] == '['));
      const char* const start = s.data() + i;
      const char* p = start;
      double value = 0.0;
      if (std::isdigit(static_cast<unsigned char>(s[i])) == 0 || !read_number(p, s.data() + s.size(), value)) continue;
      const char before = i > 0 ? s[i - 1] : '\0';
      const Place place{number, line.column[before == '#' ? i - 1 : i]};
      const double index = std::round(value);
      const bool of_tool = index >= first_of_tool && index <= last_of_tool;
      if (before == '#' && of_tool && !direct_) direct_ = place;
      // Behind a letter it is the number of a word.
      const bool may_be = before != '#' && std::isalpha(static_cast<unsigned char>(before)) == 0;
      if (may_be && (of_tool || index == number_of_tool) && !number_) number_ = place;
      i += static_cast<std::size_t>(p - start) - 1;
    }
  }

  std::optional<Place> found() const { return direct_ ? direct_ : indirect_ ? number_ : std::nullopt; }

 private:
  std::optional<Place> direct_, number_;
  bool indirect_ = false;
};

}  // namespace

void refuse_tool_parameters(const std::string& program, std::string_view text, const ProgramTools& tools) {
  if (!tools.table.empty() && tools.table_in_inch) return;
  Search search;
  for (std::int64_t number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    search.look(text.substr(0, end), number);
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  if (const auto place = search.found()) {
    throw ReadError(program, place->line, place->column,
                    "#5401 to #5413 are lengths and diameters of a tool, which LinuxCNC has in its tool table: "
                    "--tool-table FILE --tool-table-inch. rs274 gives them in inch alone; for tables in mm, write the "
                    "numbers in place of the parameters");
  }
}

}  // namespace accdec
