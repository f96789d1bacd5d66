#pragma once

#include <iosfwd>

#include <accdec/program.hpp>

namespace accdec {

/// As emit_program, for LinuxCNC, whose G4 is no whole number of samples: a move of an axis that the program does not
/// use, in inverse time (G93), waits instead. A block that G61 ends takes one sample more (measured with 2.9). So one
/// sample of delay needs only G61, and d > 2 samples a move of d - 2. Stops are delays as well, because the control
/// does not see what its filters still hold.
/// @param axis  A, B, C, U, V, W, as a capital
/// @throws std::invalid_argument  if the program moves the axis or dwells, or a delay is 2 samples
void emit_for_linuxcnc(const ProgramResult& result, char axis, std::ostream& out);

/// Whether a block stands as G0 in the emitted program: a rapid move that the plan runs as fast as its axes can. A
/// slower one stands as G1 with its feed, which a feed override scales.
/// @param machine  one axis a dimension of the path, or none
bool stands_as_rapid(const Toolpath& path, std::size_t block, const Machine& machine);

}  // namespace accdec
