#pragma once

#include <accdec/gcode/arc.hpp>
#include <accdec/gcode/move_sink.hpp>
#include <accdec/gcode/spline.hpp>
#include <accdec/simulate.hpp>

namespace accdec {

/// Shared by the readers of all formats: the tool's position, and how moves reach the sink.
class MoveState {
 public:
  /// @param arc_tolerance  m, largest distance of a chord from its arc
  MoveState(LineSource& source, MoveSink& sink, double arc_tolerance)
      : source_(source), sink_(sink), arc_tolerance_(arc_tolerance) {}

  ProgramPoint position{};
  double unit = 1e-3;       ///< m per unit of length
  double feed = 0.0;        ///< units of length (or degrees) per minute; 0: none yet
  bool fed = false;         ///< by an F word, which may be 0
  double tolerance = -1.0;  ///< m, see Move
  double merge = -1.0;      ///< m, see Move
  PathControl control = PathControl::blend;
  Plane plane = Plane::xy;

  void straight(const ProgramPoint& to, bool rapid, std::size_t column);
  /// @param turns  >= 1  @param radius  nullptr: the centre is set in `arc`; else in m
  void arc(Arc arc, bool clockwise, int turns, const double* radius, std::size_t column);
  /// In X and Y. @param order  degree + 1, 2 .. the number of control points
  void spline(const std::vector<ControlPoint>& control, int order, std::size_t column);
  void stop(double dwell) { sink_.stop(dwell); }
  void pass(std::string_view words, bool with_move = false) { sink_.pass(words, with_move); }
  void select(std::string_view word) { sink_.select(word); }
  void frame(bool percent, std::string_view label, std::string_view end) { sink_.frame(percent, label, end); }

  /// Axes of a plane, in the order in which angles turn positively.
  static std::size_t first_axis(Plane plane) { return plane == Plane::xy ? 0 : plane == Plane::zx ? 2 : 1; }
  static std::size_t second_axis(Plane plane) { return plane == Plane::xy ? 1 : plane == Plane::zx ? 0 : 2; }

 private:
  void require_feed(std::size_t column) const;
  void send(const ProgramPoint& to, bool rapid, bool inside_arc, std::size_t column);
  /// m, of chords from their arc: at most an eighth of the tolerance in force, a third in an exact path mode. Between
  /// joints the motion may be off by this more, so the tolerances of joints leave room for it.
  double chord_distance() const;

  LineSource& source_;
  MoveSink& sink_;
  double arc_tolerance_;
};

}  // namespace accdec
