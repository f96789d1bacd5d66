#include <cmath>

#include <accdec/gcode/program_frame.hpp>

namespace accdec {
namespace {

void rotate(ProgramPoint& p, double angle) {
  if (angle == 0.0) return;
  const double x = p[0], y = p[1], c = std::cos(angle), s = std::sin(angle);
  p[0] = c * x - s * y;
  p[1] = s * x + c * y;
}

}  // namespace

ProgramPoint ProgramFrame::to_machine(ProgramPoint program) const {
  for (std::size_t a = 0; a < program_axis_count; ++a) program[a] += g92[a];
  rotate(program, rotation);
  for (std::size_t a = 0; a < program_axis_count; ++a) program[a] += system[a] + tool[a];
  return program;
}

ProgramPoint ProgramFrame::to_program(ProgramPoint machine) const {
  for (std::size_t a = 0; a < program_axis_count; ++a) machine[a] -= system[a] + tool[a];
  rotate(machine, -rotation);
  for (std::size_t a = 0; a < program_axis_count; ++a) machine[a] -= g92[a];
  return machine;
}

}  // namespace accdec
