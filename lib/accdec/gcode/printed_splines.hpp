#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <accdec/gcode/canonical_position.hpp>
#include <accdec/gcode/move_state.hpp>

namespace accdec {

/// rs274 -g prints that there is a spline, but not which. So its copy of a program has lines beside each spline that
/// make it print the numbers of the spline's words, with six decimals, as a message.
///
/// @param words  of a line, in capitals, without blanks, comments and its number
/// @param line  the same as written  @param number  "N.." for the lines of the copy
/// @param open  inside control points of G5.2, whose lines need no G word; updated
/// @returns the lines for the copy; none if the line is no spline, or has not the words that it needs
std::vector<std::string> lines_with_spline(const std::string& words, std::string_view line, const std::string& number,
                                           bool& open);

/// Puts splines together from what rs274 prints: the call NURBS_FEED and those messages.
class PrintedSplines {
 public:
  /// References are kept.
  PrintedSplines(LineSource& source, MoveState& state, CanonicalPosition& position)
      : source_(source), state_(state), position_(position) {}

  /// A call NURBS_FEED in the line of the source.
  void feed(std::size_t column);
  /// Text of a message. @throws ReadError if the spline is impossible
  void message(std::string_view text);
  /// Anything else happens: a spline must be complete. @throws ReadError if it is not
  void leave();

 private:
  struct Numbers {
    std::optional<double> x, y, i, j, p, q, l, absolute;
  };
  static Numbers numbers_of(std::string_view text);
  [[noreturn]] void unknown(std::size_t column) const;
  void curve(const Numbers& numbers, bool cubic);
  void control_point(const Numbers& numbers);
  void close(std::size_t column);
  /// A point of the program, m, in the machine's coordinates.
  ControlPoint point(double x, double y, double weight = 1.0) const;

  LineSource& source_;
  MoveState& state_;
  CanonicalPosition& position_;
  struct {
    std::size_t column = 0;  // 0: none
    std::int64_t line = 0;
  } waiting_;                              // a call whose message is to come
  std::optional<double> next_i_, next_j_;  // of a cubic that continues; in the unit of the program
  std::vector<ControlPoint> open_;         // of G5.2
  ProgramPoint last_{};                    // of them
  int order_ = 3;
};

}  // namespace accdec
