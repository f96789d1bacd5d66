#pragma once

#include <accdec/filter.hpp>

namespace accdec {

/// sigma^2 of the taps about their mean delay, in sample periods squared.
double tap_variance(const Filter& filter);

/// A circle passed at constant feed, and the effect of a filter on it. The filter averages points of the circle, so the
/// path shrinks to a circle of radius R |H|, H = sum b_i exp(-j i v T/R).
struct CircleError {
  double radius_error = 0.0;  ///< m, R - R |H|, when the filter sees only the circle
  double small_angle = 0.0;   ///< m, v^2 sigma^2/(2 R), the first term of radius_error for v sigma << R; sigma is the
                              ///< standard deviation of the taps in s
  double simulated =
      0.0;  ///< m, largest distance of the filtered samples from the commanded circle, a whole turn from rest to rest
  double deviation = 0.0;  ///< s, sigma
};

/// The sums take time with the square of the order: longer filters are refused.
inline constexpr int circle_order_max = 19'999;

/// @param radius  m, > 0  @param feed  m/s, > 0  @param sample_period  s, > 0
/// @throws std::invalid_argument when one of them is not positive and finite, when one sample moves along more than
/// half the circle, or when the filter is longer than circle_order_max
CircleError circle_error(const Filter& filter, double radius, double feed, double sample_period);

}  // namespace accdec
