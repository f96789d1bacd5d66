#pragma once

#include <span>

#include <accdec/program/read/toolpath.hpp>
#include <accdec/program/simulate/leg_filters.hpp>

namespace accdec {

/// Widens the commanded radius of arcs by what the filter takes away. At the speed v in the plane it moves a circle of
/// radius R inwards by e = v^2 s^2/(2 R), s^2 its variance (see circle_error); commanded R + w with w = e R/(R + w),
/// what is left is of the order e^2/R. The speed is that of the command, averaged over the filter, so that w follows
/// ramps and stops. Where arcs meet smoothly in the same sense, w goes on; towards other blocks it comes down to 0
/// within the filter's length, which leaves some of the error there. The ends of arcs and all other points stay.
///
/// The points before are kept as Toolpath::programmed, from where errors are measured. Speeds along the path stay, so
/// durations grow with the radius and no feed becomes larger.
/// @param path    its blocks may be split; widened at most once
/// @param delays  samples, one a block
void compensate_arcs(Toolpath& path, const LegFilters& filters, std::span<const int> delays, double sample_period);

}  // namespace accdec
