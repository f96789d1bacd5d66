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
/// With chains, a window may also be a chain of joints between which an axis goes back and forth, by D_1, D_2, .. m at
/// least when tolerances are taken off. Let h_i be the times between the joints, T their sum, and w_i = 1 for a way
/// with a free end, else 2. Let K(t) be 1 and -1 by turns at the joints inside and 0 at free ends, linear between
/// joints. The integral of K x'' is at most A T/2. It is also the sum of w_i D_i/h_i, or more. So T >= sqrt(2/A)
/// (sqrt(w_1 D_1) + sqrt(w_2 D_2) + ..), whatever the times h_i are.
/// @param wider  m, added to all tolerances
double window_bound(const Toolpath& path, const Machine& machine, double wider, std::size_t first, std::size_t last,
                    bool chains = false);

/// Least time for `distance` at `speed` at most, with `rests` (0 to 2) of its ends at rest and `acceleration` there.
double time_from_rest(double distance, double speed, double acceleration, int rests);

}  // namespace accdec
