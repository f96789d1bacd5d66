#pragma once

#include <cstddef>

#include <accdec/bounds/swing_times.hpp>
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
/// With chains, a window may also be a chain of joints between which an axis goes back and forth. Its ways are those
/// between the joints less their tolerances, and SwingTimes says what each takes. A joint at rest counts as a turn.
/// @param wider  m, added to all tolerances  @param chains  nullptr: none
double window_bound(const Toolpath& path, const Machine& machine, double wider, std::size_t first, std::size_t last,
                    const SwingTimes* chains = nullptr);

/// Least time for `distance` at `speed` at most, with `rests` (0 to 2) of its ends at rest and `acceleration` there.
double time_from_rest(double distance, double speed, double acceleration, int rests);

}  // namespace accdec
