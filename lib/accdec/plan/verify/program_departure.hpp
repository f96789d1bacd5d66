#pragma once

#include <string>

#include <accdec/simulate.hpp>

namespace accdec {

/// Compares a commanded path with the program. Every programmed point must be passed in order and on straight lines
/// between the points. No feed may be above the programmed one. Tolerances, joints and lines must be the same, and
/// every stop and dwell kept. Empty if all agree, else the first difference.
std::string departs_from(const Toolpath& commanded, const Toolpath& programmed);

/// Gives a commanded path the arcs of the program, at the commands that their chords became; none if it departs.
void take_arcs(Toolpath& commanded, const Toolpath& programmed);

}  // namespace accdec
