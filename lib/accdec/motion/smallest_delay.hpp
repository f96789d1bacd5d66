#pragma once

#include <vector>

#include <accdec/motion/filter.hpp>

namespace accdec {

/// Smallest command delay that brings a corner's error at samples within a bound, for a fixed filter (or pair), found directly:
/// built once per filter, then called for millions of corners.
class DelayFinder {
 public:
  explicit DelayFinder(const Filter& filter) : DelayFinder(filter, filter) {}
  DelayFinder(const Filter& filter_in, const Filter& filter_out);

  /// @param cos_interior  cos(theta), -1 .. 1
  /// @param step_in       v1 T, m, > 0: length of a full-speed sample of leg 1
  /// @param step_out      v2 T, m, > 0
  /// @param error_max     bound on min_k |S[k]|, m, >= 0
  /// @return the smallest d >= 0 with corner error <= error_max; never more than the d of an exact stop.
  int operator()(double cos_interior, double step_in, double step_out, double error_max) const;
};

}  // namespace accdec
