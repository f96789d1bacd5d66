#include <cmath>

#include <accdec/gcode/canonical_position.hpp>

namespace accdec {

double CanonicalPosition::coordinate(double printed, std::size_t axis) {
  const double unit = unit_of(axis, state_.unit), value = printed * unit;
  const double old_unit = unit_of(axis, printed_unit_);
  const bool same = unit == old_unit && printed_[axis] ? printed == *printed_[axis]
                                                       : std::abs(value - here_[axis]) <= 0.5001e-4 * (unit + old_unit);
  printed_[axis] = printed;
  return same ? here_[axis] : value;
}

void CanonicalPosition::set_frame(const ProgramFrame& frame) {
  if (frame == frame_) return;
  frame_ = frame;
  here_ = frame_.to_program(state_.position);
  printed_ = {};
}

ProgramPoint CanonicalPosition::machine_of(const ProgramPoint& to) const {
  ProgramPoint machine = frame_.to_machine(to);
  for (std::size_t a = 0; a < program_axis_count; ++a) {
    const bool with_others = frame_.rotation != 0.0 && a < 2;
    const bool still = with_others ? to[0] == here_[0] && to[1] == here_[1] : to[a] == here_[a];
    if (still) machine[a] = state_.position[a];
  }
  return machine;
}

}  // namespace accdec
