#pragma once

#include <array>
#include <vector>

namespace accdec {

/// A control point of a spline in a plane.
struct ControlPoint {
  double x = 0.0, y = 0.0;  ///< m
  double weight = 1.0;      ///< > 0
};

/// Points of the rational B-spline of `order` (degree + 1) through the first and the last control point. The knots are
/// 0 (`order` times), 1, 2, .., and the last value `order` times, as LinuxCNC places them (nurbs_funcs.cc). The start
/// is left out, the last point is the end.
///
/// Every chord is within `tolerance` of its part of the curve. Each knot span becomes a Bezier piece by blossoms (polar
/// forms). Pieces are halved until their control points are this near to the chord; their hull contains the curve.
/// @param order      2 .. the number of control points  @param tolerance  m, > 0
/// @return empty if that were more than 10 million chords
std::vector<std::array<double, 2>> flatten_spline(const std::vector<ControlPoint>& control, int order,
                                                  double tolerance);

}  // namespace accdec
