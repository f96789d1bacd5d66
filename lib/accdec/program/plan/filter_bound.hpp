#pragma once

#include <accdec/machine/machine.hpp>
#include <accdec/program/read/toolpath.hpp>

namespace accdec {

/// Least mean distance, in samples, between what slows the first leg of a corner and what starts the second: Delta = d
/// + M2 - M1 over all delays d and all pairs of filters, M their mean delays, whose taps are at most tap_in and tap_out
/// and with which the corner error at the samples is at most `error`; rounded down by at most 1e-3.
///
/// Counted from the sample of closest approach, filter 1 has taps b_i and filter 2, d samples later, c_i. With p = sum
/// b_i max(i, 0), q = sum c_i max(-i, 0) and p', q' the same sums on the other side, Delta = p' - p + q' - q, and the
/// error is that of S = -p s1 u1 + q s2 u2. Given p, the most mass that may lie after the sample is that of taps as
/// large and as near to it as allowed; what remains lies as near before it as it can, which gives the least p'. Both
/// decrease with p and q, so the least Delta is on the ellipse |S| = error, and on an arc of it not below the value at
/// the largest p and the largest q of the arc: arcs are halved until that is known well enough.
/// @param step_in, step_out  v T of both legs, m  @param tap_in, tap_out  in (0, 1]  @param cos_interior  of the
/// interior angle
double least_separation(double step_in, double step_out, double tap_in, double tap_out, double cos_interior,
                        double error);

/// A time that no filters with non-negative taps and unit sum, one for all legs or one a leg, with any delays undercut
/// under the acceleration limits, s: with n samples of command and by what was said above, samples = n + sum d + N_last
/// + 1 = n + M_first + sum Delta + (N_last + 1 - M_last), each term as small as it can be by itself.
///
/// It is a bound for filters that are not longer than the blocks that meet at a corner: then a corner is passed as if
/// it were alone. What it leaves out, and may therefore be too low by: that one filter must suit both ends of a leg,
/// limits while the legs overlap, limits other than those of acceleration, whole samples.
/// @param machine  as many axes as the path, or without axes
double filter_lower_bound(const Toolpath& path, const Machine& machine, double sample_period);

}  // namespace accdec
