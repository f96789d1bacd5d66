#pragma once

#include <vector>

#include <accdec/machine/response.hpp>
#include <accdec/simulate.hpp>

namespace accdec {

/// Largest parts of the blocks' feeds at which servos that differ keep the motion within Toolpath::contour_max of each
/// block's line, 1 at most. Only blocks that last longer than the motion's filter count: shorter ones need not be as
/// far off as at constant feed.
std::vector<double> parts_within_contour(const Toolpath& path, const FilterBehind& behind, double sample_period);

/// The same for every block by itself, begun at rest: also on the way to its feed.
std::vector<double> parts_from_rest(const Toolpath& path, const FilterBehind& behind, double sample_period);

/// Slows the blocks to these parts of their feeds, and returns them. The feeds of arcs that are not widened fall to
/// those at which their radius errors are within the contour, see RadiusError.
std::vector<double> hold_contour(Toolpath& path, const FilterBehind& behind, double sample_period);

}  // namespace accdec
