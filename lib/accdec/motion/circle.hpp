#pragma once

#include <accdec/filter.hpp>

namespace accdec {

/// sigma^2 of the taps about their mean delay, in sample periods squared.
double tap_variance(const Filter& filter);

/// A circle passed at constant feed, and the effect of a filter on it. The filter averages points of the circle, so the
/// path shrinks to a circle of radius R |H|, H = sum b_i exp(-j i v T/R). If both axes of its plane have a filter each,
/// it is an ellipse, whose radii have the squares R^2 (|Hx|^2 + |Hy|^2 +- |Hx^2 - Hy^2|)/2.
struct CircleError {
  double radius_error =
      0.0;                   ///< m, largest distance of that path from the circle, when the filters see only the circle
  double small_angle = 0.0;  ///< m, first term of radius_error for v sigma << R: v^2 sigma^2/(2 R), and half of the
                             ///< way by which one axis lags behind the other
  double simulated =
      0.0;  ///< m, largest distance of the filtered samples from the commanded circle, a whole turn from rest to rest
  double deviation = 0.0;  ///< s, sigma: standard deviation of the taps, root mean square of both axes
};

/// The sums take time with the square of the order: longer filters are refused.
inline constexpr int circle_order_max = 19'999;
inline constexpr double circle_sums_max = 1e9;

/// @param radius  m, > 0  @param feed  m/s, > 0  @param sample_period  s, > 0
/// @throws std::invalid_argument unless all are positive and finite, and a sample moves along less than half the
/// circle. Filters longer than circle_order_max are refused, and different ones that meet more than circle_sums_max
/// products in half a turn.
CircleError circle_error(const Filter& x, const Filter& y, double radius, double feed, double sample_period);
inline CircleError circle_error(const Filter& filter, double radius, double feed, double sample_period) {
  return circle_error(filter, filter, radius, feed, sample_period);
}

}  // namespace accdec
