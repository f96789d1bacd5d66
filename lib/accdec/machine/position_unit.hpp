#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <accdec/machine.hpp>

namespace accdec {

/// m: the most by which rounding to whole numbers of the control's unit moves a position, half a unit in every axis.
inline double unit_rounding(const Machine& machine, std::size_t axes) {
  return 0.5 * machine.position_unit * std::sqrt(static_cast<double>(axes));
}

/// m, >= 0: the part of a contour that a motion may use before its positions are rounded. Steps between two rounded
/// positions are within the contour, too: no point of them moves by more than both ends.
inline double contour_in_units(double contour, const Machine& machine, std::size_t axes) {
  return std::max(0.0, contour - unit_rounding(machine, axes));
}

}  // namespace accdec
