#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

namespace accdec {

/// Distance of two points of n values.
inline double distance(const double* a, const double* b, std::size_t n) {
  double sum = 0.0;
  for (std::size_t i = 0; i < n; ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum);
}

/// The part of the motion examined for the error of a joint.
struct JointWindow {
  std::size_t block = 0;             ///< the block whose end point it is
  std::int64_t first = 0, last = 0;  ///< samples, first <= last
  bool path = false;                 ///< distance from the segments between the samples instead of the samples
};

/// Samples past the end of its window that least_squared and path_squared may read.
inline constexpr std::int64_t nearest_margin = 16;

/// Squares of the least distances of joints from the samples of their windows, or from the path through these.
/// @param position  of every axis by sample number
/// @param n         number of axes
/// @param points    rows of n; the joint at the end of block b is row b + 1
void least_squared(const double* const* position, std::size_t n, const double* points, const JointWindow* joints,
                   std::size_t count, double* squared);

/// Square of the least distance of a point from the path through samples first .. last, first < last.
double path_squared(const double* const* position, std::size_t n, const double* point, std::int64_t first,
                    std::int64_t last);

}  // namespace accdec
