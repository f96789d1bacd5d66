#pragma once

#include <accdec/simulate.hpp>

namespace accdec {

/// The frame of a program's coordinates: offsets of coordinate systems (G54 .. G59.3, G92), rotation, and tool lengths.
/// As in LinuxCNC, a machine position starts from the program position plus the offset of G92, rotated in X and Y. Then
/// the offsets of the coordinate system and of the tool are added.
struct ProgramFrame {
  ProgramPoint g92{}, system{}, tool{};  ///< m, see `program_axes`
  double rotation = 0.0;                 ///< rad, from X to Y

  bool operator==(const ProgramFrame&) const = default;
  ProgramPoint to_machine(ProgramPoint program) const;
  ProgramPoint to_program(ProgramPoint machine) const;
};

}  // namespace accdec
