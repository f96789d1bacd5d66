#pragma once

#include <cstddef>
#include <vector>

#include <accdec/machine/response.hpp>
#include <accdec/simulate.hpp>

namespace accdec {

/// The radius error of arcs passed at constant speed. The filter of an axis, with variance s^2, averages points of the
/// circle, so that the path moves inwards by R (1 - |H|) <= v^2 s^2/(2 R). Between samples T apart the polyline cuts up
/// to (v T)^2/(8 R) more. If one axis of the plane lags behind the other by t, the circle becomes an ellipse, off by
/// v t/2 more.
class RadiusError {
 public:
  /// @param dimensions  axes of the path
  RadiusError(const FilterBehind& behind, std::size_t dimensions, double sample_period);

  /// Largest speed in the plane of an arc, m/s, at which the error is at most `bound`, m, > 0.
  double speed(const PathArc& arc, double bound) const;

 private:
  std::vector<double> deviation2_;  // s^2, of every axis; sampling included
  std::vector<double> lag_;         // s, of every axis
};

/// The rest of a bound if chords of this sagitta take their part; a tenth at least.
double beside_chords(double bound, double sagitta);
/// Largest distance of the chords of an arc from it, m.
double sagitta_of(const PathArc& arc);

}  // namespace accdec
