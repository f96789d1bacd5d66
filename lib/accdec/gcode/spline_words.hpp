#pragma once

#include <cstdint>
#include <vector>

#include <accdec/gcode/move_state.hpp>
#include <accdec/gcode/spline.hpp>
#include <accdec/gcode/words.hpp>
#include <accdec/simulate.hpp>

namespace accdec {

/// G5, G5.1, G5.2 and G5.3 in tenths.
constexpr bool is_spline(int tenths) {
  return tenths >= 50 && tenths <= 53;
}

/// Splines in the XY plane by the rules of LinuxCNC (interp_convert.cc, convert_spline and convert_nurbs). G5 I J P Q
/// is a cubic; its second and third control points are given from its start and its end. Without I J it continues
/// smoothly from the G5 before it. G5.1 I J is quadratic. G5.2 opens a list of control points X Y with their weights P
/// and the order L (3 if smaller or not given). The first of them is the position. G5.3 closes it and moves.
class SplineWords {
 public:
  /// References are kept.
  SplineWords(LineSource& source, MoveState& state) : source_(source), state_(state) {}

  /// A block of a spline mode. @param absolute  G90 holds  @param to  where its axis words point
  /// @return letters used  @throws ReadError where a word is missing or out of place
  std::uint32_t block(const Words& words, int tenths, Plane plane, bool absolute, const ProgramPoint& to,
                      std::size_t column);
  /// Another kind of move, or the end of the program: the next G5 has none before it.
  /// @throws ReadError inside a list that G5.3 did not close
  void leave(std::size_t column);

 private:
  void cubic(const Words& words, const ProgramPoint& to, std::size_t column);
  void quadratic(const Words& words, const ProgramPoint& to, std::size_t column);
  void control_point(const Words& words, const ProgramPoint& to, std::size_t column);
  void close(std::size_t column);

  LineSource& source_;
  MoveState& state_;
  bool continues_ = false;  // a G5 came before
  double next_i_ = 0.0, next_j_ = 0.0;
  std::vector<ControlPoint> open_;  // of G5.2
  int order_ = 3;
};

}  // namespace accdec
