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

/// Largest error of a corner, m, if a symmetric motion is as far from the legs as the contour in m allows. With the
/// interior angle a it is contour/sin(a/2). The corner of two strips as wide is as far away.
/// @param in, out  directions of the legs, unit vectors of n values
double error_within_contour(double contour, const double* in, const double* out, std::size_t n);

/// The path with no tolerance larger than that. Without a contour, the path itself.
Toolpath within_contour(const Toolpath& path);

}  // namespace accdec
