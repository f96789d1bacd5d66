#pragma once

#include <optional>

#include <accdec/machine.hpp>
#include <accdec/simulate.hpp>

namespace accdec {

/// Block b is a chord of an arc: other chords move with it when it is fastest.
inline bool is_chord(const Toolpath& path, std::size_t b) {
  return path.inside_arc[b] != 0 || (b > 0 && path.inside_arc[b - 1] != 0);
}

/// Least mean distance, in samples, between the slowing of a corner's first leg and the start of the second. It is
/// Delta = d + M2 - M1 over all delays d and all pairs of filters with mean delays M. Their taps are at most tap_in and
/// tap_out, and the corner error at the samples is at most `error`. The result is rounded down by at most 1e-3.
/// THEORY.md, "Filters and delays", derives it.
/// @param step_in, step_out  v T of both legs, m  @param tap_in, tap_out  in (0, 1]  @param cos_interior  of the
/// interior angle
double least_separation(double step_in, double step_out, double tap_in, double tap_out, double cos_interior,
                        double error);

/// A lower bound in s on the time of plans that keep the programmed feeds within the acceleration limits. They have any
/// filters with non-negative taps and unit sum, and any delays. There may be one filter for all legs or one per leg.
/// With n samples of command, samples = n + sum d + N_last + 1 = n + M_first + sum Delta + (N_last + 1 - M_last). Each
/// term takes its own minimum.
///
/// It holds for filters that are not longer than the blocks that meet at a corner: then each corner is passed as if it
/// were alone. There is no such bound where a block is shorter than every filter that starts it within the limits.
/// Plans that choose slower feeds, or step them inside blocks, may be faster. Chords of arcs are shorter than filters.
/// So an arc starts and stops with any tap here, and joints inside it cost nothing. It may be too low, because it
/// leaves out several conditions. One filter must suit both ends of a leg, limits hold while the legs overlap, limits
/// other than acceleration hold, and samples are whole.
/// @param machine  its axes are found by their names (program_machine)
std::optional<double> filter_lower_bound(const Toolpath& path, const Machine& machine, double sample_period);

}  // namespace accdec
