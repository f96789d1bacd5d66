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
/// A window has a joint in its middle, or with chains ways of an axis to and fro. THEORY.md, "Windows of fine chords",
/// derives what it takes.
/// @param wider  m, added to all tolerances  @param chains  nullptr: none
double window_bound(const Toolpath& path, const Machine& machine, double wider, std::size_t first, std::size_t last,
                    const SwingTimes* chains = nullptr);

/// Least time for `distance` at `speed` at most, with `rests` (0 to 2) of its ends at rest and `acceleration` there.
double time_from_rest(double distance, double speed, double acceleration, int rests);

}  // namespace accdec
