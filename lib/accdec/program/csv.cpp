#include <accdec/program/reader.hpp>

#include <string>
#include <vector>

#include <accdec/program/number.hpp>

namespace accdec {
namespace {

constexpr std::size_t feed_column = program_axis_count;

std::string column_name(std::size_t axis) {
  if (axis == feed_column) return "feed_mm_min";
  return static_cast<char>(program_axes[axis] | 0x20) + std::string(axis >= 3 && axis < 6 ? "_deg" : "_mm");
}

bool passed_over(std::string_view line) {
  const std::size_t i = line.find_first_not_of(" \t");
  return i == std::string_view::npos || line[i] == '#';
}

std::vector<std::size_t> read_header(LineSource& source, std::string_view line) {
  std::vector<std::size_t> columns;
  std::size_t start = 0;
  for (;;) {
    const std::size_t comma = line.find(',', start);
    std::string_view name = line.substr(start, comma == std::string_view::npos ? comma : comma - start);
    const std::size_t first = name.find_first_not_of(" \t"), last = name.find_last_not_of(" \t");
    name = first == std::string_view::npos ? std::string_view{} : name.substr(first, last - first + 1);
    std::size_t axis = 0;
    while (axis <= feed_column && column_name(axis) != name) ++axis;
    if (axis > feed_column) {
      source.fail(start + 1, "unknown column '" + std::string(name.substr(0, 40)) +
                                 "', allowed: x_mm y_mm z_mm a_deg b_deg c_deg u_mm v_mm w_mm feed_mm_min");
    }
    for (const std::size_t other : columns) {
      if (other == axis) source.fail(start + 1, "column '" + std::string(name) + "' twice");
    }
    columns.push_back(axis);
    if (comma == std::string_view::npos) return columns;
    start = comma + 1;
  }
}

}  // namespace

void read_csv(LineSource& source, const ReadOptions&, MoveSink& sink) {
  std::string_view line;
  do {
    if (!source.next(line)) return;
  } while (passed_over(line));
  const std::vector<std::size_t> columns = read_header(source, line);
  bool has_feed = false;
  for (const std::size_t c : columns) has_feed = has_feed || c == feed_column;
  if (!has_feed || columns.size() < 2) source.fail(1, "the table needs a column feed_mm_min and one of an axis");

  ProgramPoint position{};
  bool first = true;
  while (source.next(line)) {
    if (passed_over(line)) continue;
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
      if (!read_number(p, end, value) && !(feed_of_start && (p == end || *p == ','))) {
        source.fail(value_at, "not a number from -1e12 to 1e12");
      }
      if (columns[c] == feed_column) {
        feed = value;
        feed_at = value_at;
      } else {
        move.to[columns[c]] = value * 1e-3;
      }
      blanks();
      if (c + 1 < columns.size() ? p == end || *p != ',' : p != end) {
        source.fail(at(), "the row must have " + std::to_string(columns.size()) + " values");
      }
      if (p != end) ++p;
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
