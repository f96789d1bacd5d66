#pragma once

#include <cstddef>

#include <accdec/machine.hpp>
#include <accdec/simulate.hpp>

namespace accdec {

/// A time that no motion of blocks first .. last, between two stops, undercuts, s: the largest sum over windows of the
/// program that follow each other. It is for fine chords of curves, which give no bound one by one, because they are no
/// longer than their tolerance.
///
/// A window runs from joint i to joint k with a joint j in its middle. Let e be their tolerances, v the highest feed in
/// it, and A the acceleration of the axes along a direction.
///
/// - It takes the distance |p_k - p_i| - e_i - e_k over v. If it begins or ends at rest, the time to speed up or slow
///   down is added.
/// - Let h be the distance of p_j from its chord. Across the chord the motion must move h - e_j - max(e_i, e_k) aside
///   between two moments. This takes sqrt(8 (..)/A), because no motion with |x''| <= A leaves its own chord by more
///   than A t^2/8.
/// @param wider  m, added to all tolerances
double window_bound(const Toolpath& path, const Machine& machine, double wider, std::size_t first, std::size_t last);

/// Least time for `distance` at `speed` at most, with `rests` (0 to 2) of its ends at rest and `acceleration` there.
double time_from_rest(double distance, double speed, double acceleration, int rests);

}  // namespace accdec
