#pragma once

#include <array>
#include <optional>

#include <accdec/gcode/move_state.hpp>
#include <accdec/gcode/program_frame.hpp>

namespace accdec {

/// The position of a program of canonical calls: in its own frame, and as its coordinates were printed last.
class CanonicalPosition {
 public:
  /// @param state  the machine's position and the unit; the reference is kept
  explicit CanonicalPosition(const MoveState& state) : state_(state) { printed_.fill(0.0); }

  /// m or rad of a printed number of this axis.
  double scaled(double printed, std::size_t axis) const { return printed * unit_of(axis, state_.unit); }
  /// The position that the axis must go to, by the coordinate that a move prints.
  ///
  /// Coordinates are printed with 4 decimals. A coordinate that has not moved prints the same text. But after a change
  /// of unit it differs by its rounding. Then it must not move; otherwise full circles would be lost and rotary moves
  /// would count as moves of X.
  double coordinate(double printed, std::size_t axis);
  /// Call after the coordinates of a move: they were printed in the present unit.
  void end_of_coordinates() { printed_unit_ = state_.unit; }

  const ProgramPoint& here() const { return here_; }  ///< in the program's frame
  void go(const ProgramPoint& to) { here_ = to; }
  /// To a point in X and Y that no call printed, with more decimals than those of the next one.
  void go_unprinted(const ProgramPoint& to) {
    here_ = to;
    printed_[0] = printed_[1] = std::nullopt;
  }
  const ProgramFrame& frame() const { return frame_; }
  /// The machine stays where it is; the program's coordinates of it change.
  void set_frame(const ProgramFrame& frame);
  /// The machine's point for one of the program. Axes of the program that do not move keep the machine's where they
  /// are, to the bit.
  ProgramPoint machine_of(const ProgramPoint& to) const;

 private:
  static double unit_of(std::size_t axis, double length) { return axis >= 3 && axis < 6 ? 1e-3 : length; }

  const MoveState& state_;
  ProgramFrame frame_;
  ProgramPoint here_{};
  std::array<std::optional<double>, program_axis_count> printed_;  // if it was in this frame
  double printed_unit_ = 1e-3;                                     // m a unit then
};

}  // namespace accdec
