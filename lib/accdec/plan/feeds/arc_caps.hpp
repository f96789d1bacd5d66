#pragma once

#include <optional>

#include <accdec/machine/response.hpp>
#include <accdec/plan/feeds/feed_march.hpp>
#include <accdec/plan/feeds/feed_window.hpp>
#include <accdec/plan/feeds/radius_error.hpp>
#include <accdec/simulate.hpp>

namespace accdec {

/// The arc that block b is a chord of; nullptr if none.
const PathArc* arc_of(const Toolpath& path, std::size_t b);

/// Speeds on arcs and helices by the arcs themselves, whatever their chords. Let v be the speed in the plane, R the
/// radius and w = v/R. The velocity turns by w tau1 within the window of a filter (see FeedWindow), so that it changes
/// by
///   2 v sin(w tau1/2)                      <= tau1 a_max         that is v^2/R <= a_max for short windows, and
///   4 v sin(w tau1/2) sin(w tau2/2)        <= tau1 tau2 j_max    v^3/R^2 <= j_max.
/// Each is multiplied by the part of an axis in the normal or the tangent, for the worst heading within the window.
/// Force and power hold at the speeds of the axes there. RadiusError gives the speed within a tolerance, of which the
/// chords of the command take their sagitta.
class ArcCaps {
 public:
  /// References are kept.
  ArcCaps(const Toolpath& path, const FeedPath& feeds, const FilterBehind& behind, const FeedWindow& window,
          double sample_period);

  /// Largest constant speed along the path at the joint at the end of block b. None if that joint is on no arc, or if
  /// the filter reaches beyond the ends of the arc.
  /// @param tolerance  m, of the radius
  std::optional<double> speed(std::size_t b, double tolerance) const;

 private:
  const Toolpath& path_;
  const FeedPath& feeds_;
  const FeedWindow& window_;
  RadiusError radius_error_;
};

}  // namespace accdec
