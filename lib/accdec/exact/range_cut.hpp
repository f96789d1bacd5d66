#pragma once

#include <cstddef>
#include <vector>

#include <accdec/certificate.hpp>
#include <accdec/exact/box.hpp>
#include <accdec/filter.hpp>

// Internal to the exact method: cuts for a corner whose delay and sample are still ranges.

namespace accdec::exact {

using proof::Tangent;

/// A cut wp p + wq q <= bound over all delays and samples of a corner's ranges. It is linear in the taps, the delay d
/// and the sample k; the linear program has d and k as continuous variables. The sequences p_k and q_m, with m = k - d,
/// are convex in k and m, and their slopes are the responses. So each lies above its tangent at any sample a:
///   p_k >= p_a - (k - a)(1 - B_e),  q_m >= q_a + (m - a) B_e,  e = a or a + 1,
/// and the products are bounded by the tube's bounds on B_e (McCormick, Math. Program. 10, 1976). The target's bound on
/// all delays together then decides which of them may be long, without a split.
struct RangeRow {
  std::vector<double> taps;
  double on_sample = 0.0;  ///< of k - k1
  double on_delay = 0.0;   ///< of d - d1
  double constant = 0.0;
};
RangeRow range_row(const Box& box, std::size_t corner, const Tangent& in, const Tangent& out, double weight_in,
                   double weight_out);

/// The tangents highest at a filter, a delay and a sample, and their values there (>= 0), in samples at full speed.
struct HighestTangents {
  Tangent in, out;
  double distance_in = 0.0, distance_out = 0.0;
};
/// @param delay, sample  of d - d1 and k - k1, from the linear program
HighestTangents highest_tangents(const Filter& filter, const Box& box, std::size_t corner, double delay, double sample);

}  // namespace accdec::exact
