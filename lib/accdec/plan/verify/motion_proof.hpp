#pragma once

#include <accdec/machine.hpp>
#include <accdec/program.hpp>
#include <accdec/simulate.hpp>

namespace accdec {

/// The time that multipliers prove for any motion of a program, s. THEORY.md, "Weights of a whole motion", derives the
/// sum whose least value this is. The code that seeks the multipliers takes no part. The path and its tubes are made
/// again here, and the least value is found by bisection of the times of every leg.
///
/// The motion lies in the tubes that TubeCheck keeps samples in, and is no faster than it allows. Sections without
/// multipliers count nothing.
/// @param machine  its axes are found by their names (program_machine)
/// @throws std::invalid_argument for multipliers that are not those of the program's blocks and axes
double proved_time(const Toolpath& path, const Machine& machine, double sample_period,
                   const std::vector<MotionProof>& proofs);

}  // namespace accdec
