#pragma once

#include <cstddef>

#include <accdec/machine/machine.hpp>
#include <accdec/program/read/toolpath.hpp>

namespace accdec {

/// A time that no motion of blocks first .. last, between two stops, undercuts, s: the largest sum over windows of the
/// program that follow each other. For fine chords of curves, which one by one say nothing: they are no longer than
/// their tolerance.
///
/// For a window from joint i to joint k with a joint j in its middle, e their tolerances, v the highest feed in it, A
/// what the axes can accelerate along a direction:
/// - it takes the way |p_k - p_i| - e_i - e_k over v, and where it begins or ends at rest what speeding up costs;
/// - across its chord, h the distance of p_j from it, the motion has to go h - e_j - max(e_i, e_k) aside between two
///   moments, which takes sqrt(8 (..)/A): nothing with |x''| <= A leaves its own chord by more than A t^2/8.
/// @param wider  m, added to all tolerances
double window_bound(const Toolpath& path, const Machine& machine, double wider, std::size_t first, std::size_t last);

/// Least time for `distance` at `speed` at most, with `rests` (0 to 2) of its ends at rest and `acceleration` there.
double time_from_rest(double distance, double speed, double acceleration, int rests);

}  // namespace accdec
