#pragma once

#include <vector>

#include <accdec/machine.hpp>
#include <accdec/program.hpp>

namespace accdec {

/// Fills in what follows from the plan, its errors and the uses of its axis limits: counts and the worst of the joints,
/// vibration, whether all holds.
/// @param machine  as many axes as the path
/// @param alone    smallest delays of the plan's joints alone, samples, one a block; empty: they are found
void judge_program(ProgramResult& result, const Machine& machine, const std::vector<int>& alone = {});

}  // namespace accdec
