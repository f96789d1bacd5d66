#include <algorithm>
#include <string>
#include <vector>

#include <accdec/gcode/move_sink.hpp>
#include <accdec/gcode/number.hpp>
#include <accdec/gcode/read_formats.hpp>
#include <accdec/simulate.hpp>

namespace accdec {
namespace {

constexpr std::size_t feed_column = program_axis_count;

std::string column_name(std::size_t axis) {
  if (axis == feed_column) return "feed_mm_min";
  return static_cast<char>(program_axes[axis] | 0x20) + std::string(axis >= 3 && axis < 6 ? "_deg" : "_mm");
}

bool is_passed_over(std::string_view line) {
  const std::size_t i = line.find_first_not_of(" \t");
  return i == std::string_view::npos || line[i] == '#';
}

struct Header {
  std::vector<std::size_t> columns;
  bool commas = true;  ///< between the values; else blanks

  bool has(std::size_t axis) const { return std::find(columns.begin(), columns.end(), axis) != columns.end(); }
  bool complete() const { return has(feed_column) && columns.size() >= 2; }
};

/// Reads the names from index `start` of the line on.
/// @return the index of the first name that is none, or is there twice; npos if there is none
std::size_t read_names(std::string_view line, std::size_t start, Header& header) {
  header = {};
  header.commas = line.find(',', start) != std::string_view::npos;
  const std::string_view separators = header.commas ? "," : " \t";
  for (;;) {
    if (!header.commas) start = std::min(line.find_first_not_of(separators, start), line.size());
    const std::size_t end = std::min(line.find_first_of(separators, start), line.size());
    std::string_view name = line.substr(start, end - start);
    const std::size_t first = name.find_first_not_of(" \t"), last = name.find_last_not_of(" \t");
    name = first == std::string_view::npos ? std::string_view{} : name.substr(first, last - first + 1);
    std::size_t axis = 0;
    while (axis <= feed_column && column_name(axis) != name) ++axis;
    if (axis > feed_column || header.has(axis)) return start;
    header.columns.push_back(axis);
    start = end;
    if (header.commas ? end == line.size() : line.find_first_not_of(separators, end) == std::string_view::npos)
      return std::string_view::npos;
    if (header.commas) ++start;
  }
}

/// Finds the first line that is no comment, or a comment with only names of columns, as numpy's savetxt writes them.
bool find_header(LineSource& source, Header& header) {
  std::string_view line;
  while (source.next(line)) {
    const std::size_t start = line.find_first_not_of(" \t#");
    if (start == std::string_view::npos) continue;
    const std::size_t wrong = read_names(line, start, header);
    if (is_passed_over(line)) {
      if (wrong == std::string_view::npos && header.complete()) return true;
      continue;
    }
    if (wrong != std::string_view::npos) {
      const std::size_t end = line.find_first_of(header.commas ? "," : " \t", wrong);
      const std::string name(line.substr(wrong, std::min<std::size_t>(40, end - wrong)));
      for (const std::size_t axis : header.columns) {
        if (column_name(axis) == name) source.fail(wrong + 1, "column '" + name + "' twice");
      }
      source.fail(wrong + 1, "unknown column '" + name +
                                 "', allowed: x_mm y_mm z_mm a_deg b_deg c_deg u_mm v_mm w_mm feed_mm_min");
    }
    if (!header.complete()) source.fail(1, "the table needs a column feed_mm_min and one of an axis");
    return true;
  }
  return false;
}

}  // namespace

void read_csv(LineSource& source, const ReadOptions&, MoveSink& sink) {
  Header header;
  if (!find_header(source, header)) return;
  const std::vector<std::size_t>& columns = header.columns;
  std::string_view line;
  ProgramPoint position{};
  bool first = true;
  while (source.next(line)) {
    if (is_passed_over(line)) continue;
    const char* p = line.data();
    const char* const end = p + line.size();
    const auto at = [&] { return static_cast<std::size_t>(p - line.data()) + 1; };
    const auto blanks = [&] {
      while (p != end && (*p == ' ' || *p == '\t')) ++p;
    };
    Move move;
    double feed = 0.0;
    std::size_t feed_at = 1;
    for (std::size_t c = 0; c < columns.size(); ++c) {
      blanks();
      double value = 0.0;
      const bool feed_of_start = first && columns[c] == feed_column;
      const std::size_t value_at = at();
      if (!read_scientific(p, end, value) && !(feed_of_start && (p == end || *p == ','))) {
        source.fail(value_at, "not a number from -1e12 to 1e12");
      }
      if (columns[c] == feed_column) {
        feed = value;
        feed_at = value_at;
      } else {
        move.to[columns[c]] = value * 1e-3;
      }
      const char* const behind = p;
      blanks();
      const bool separated = header.commas ? p != end && *p == ',' : p != end && p != behind;
      if (c + 1 < columns.size() ? !separated : p != end) {
        source.fail(at(), "the row must have " + std::to_string(columns.size()) + " values" +
                              (header.commas ? ", commas between them" : ""));
      }
      if (p != end && header.commas) ++p;
    }
    move.line = source.line_number();
    move.column = 1;
    if (first) {
      sink.begin(move.to);
    } else {
      if (!(feed > 0.0)) source.fail(feed_at, "the feed must be positive");
      move.duration = feed_duration(position, move.to, feed * 1e-3 / 60.0);
      sink.move(move);
    }
    position = move.to;
    first = false;
  }
}

}  // namespace accdec
