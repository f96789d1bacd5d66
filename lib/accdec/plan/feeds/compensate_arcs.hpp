#pragma once

#include <span>

#include <accdec/machine/response.hpp>
#include <accdec/simulate.hpp>

namespace accdec {

/// Widens the commanded radius of arcs by the radius error of the motion's filter. At the speed v in the plane, a
/// filter with variance s^2 moves a circle of radius R inwards by e = v^2 s^2/(2 R) (see circle_error). The command
/// uses R + w with w = e R/(R + w). The remaining error is of the order e^2/R. The speed is the commanded one, averaged
/// over the filter, so that w follows ramps and stops. If arcs meet smoothly in the same sense, w continues. Towards
/// other blocks it falls to 0 within the filter's length, which leaves a part of the error there. The ends of arcs and
/// all other points stay.
///
/// The original points are kept as Toolpath::programmed; errors are measured from them. Speeds along the path stay, so
/// durations grow with the radius and no feed becomes larger.
/// @param path    its blocks may be split; widened at most once
/// @param delays  samples, one a block
void compensate_arcs(Toolpath& path, const FilterBehind& behind, std::span<const int> delays, double sample_period);

}  // namespace accdec
