#pragma once

#include <cstddef>
#include <functional>

#include <accdec/machine.hpp>
#include <accdec/simulate.hpp>

namespace accdec {

/// A time that no motion of blocks first .. last, between two stops, undercuts, s; 0 if none is found. It is for
/// corners so close that acceleration and jerk limit the motion all the time: curves that fill a plane, carved
/// surfaces.
///
/// The largest sum over joints and values of the weight K is found by dynamic programming. THEORY.md, "Motion that
/// acceleration and jerk limit all the time", derives it.
/// @param wider  m, added to all tolerances
/// @param work_left  steps of the search, some 3 ns each: grids are as fine as this allows. Lowered by those taken
/// @param more  whether there is time left; asked before every grid and at every joint
double kernel_bound(const Toolpath& path, const Machine& machine, double wider, std::size_t first, std::size_t last,
                    double& work_left, const std::function<bool()>& more);

}  // namespace accdec
