#pragma once

#include <functional>

#include <accdec/bounds/leg_plane.hpp>
#include <accdec/bounds/tube_window.hpp>
#include <accdec/machine.hpp>

namespace accdec {

/// The motion from a plane across one leg, by a corner, to a plane across the next one. A plane is where
/// normal . (x - corner) is -before or after; a normal has the part 1 along its leg.
struct PlaneWindow {
  const TubeLeg* in = nullptr;  ///< nullptr: from rest in the corner
  const TubeLeg* out = nullptr;
  double tolerance = 0.0;  ///< m, from the corner
  AxisVector before_normal{}, after_normal{};
  double before = 0.0, after = 0.0;  ///< m
};

/// A time that no motion from plane to plane undercuts, s, whatever its states in the planes are.
///
/// The corner is passed after a share of the time. For every share of a range, one linear program bounds the way of a
/// motion in a given time, as the sum of its ways along both normals. Its variables are the positions at 12 moments
/// before the corner and 12 after it, nearer to each other towards the corner. Steps are as long as the range allows.
/// Its rows are those of tube_loss, with divided differences of neighbouring moments. The right sides of all rows are
/// polynomials of the time. So one set of multipliers bounds the way for every time, and the time at which that bound
/// reaches the planes is a lower bound. The range of shares with the smallest time is halved until it is narrow.
/// @param more  whether another linear program may be solved
double plane_time(const PlaneWindow& window, const Machine& machine, std::size_t dimensions,
                  const std::function<bool()>& more);

}  // namespace accdec
