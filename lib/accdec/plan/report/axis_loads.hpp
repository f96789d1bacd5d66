#pragma once

#include <algorithm>
#include <vector>

#include <accdec/program.hpp>

namespace accdec {

/// The force of every axis with a load over the whole program, m a + c v and dry friction of the motion at every
/// sample. Dwells, rests and what follows behind a servo count. Reads all samples of the plan; none is read if no axis
/// has a load.
/// @param machine  as many axes as the path
std::vector<AxisLoad> axis_loads(const ProgramResult& result, const Machine& machine);

/// The task's machine with those of its axes that the program moves: what is not considered of others is not left out.
/// All axes, where there is no plan.
Machine moved_machine(const ProgramResult& result);

/// Whether any axis has a thermal rating.
inline bool has_ratings(const Machine& machine) {
  return std::ranges::any_of(machine.axes, [](const Axis& axis) { return axis.force_rms_max < unlimited; });
}

}  // namespace accdec
