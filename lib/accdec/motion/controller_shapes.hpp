#pragma once

#include <span>
#include <vector>

#include <accdec/motion/filter.hpp>

namespace accdec {

/// Shapes that controllers offer beside those of shapes.hpp. All throw std::invalid_argument when an argument is out of
/// the range given here.

/// Truncated exponential b_i ~ ratio^i, i = 0 .. N: "exponential Acc/Dec" with an end. order >= 0.
/// @param ratio  0 < ratio <= exponential_ratio_max; below 1 a one-pole filter cut off, 1 the boxcar, above 1 rising: a
///               start as smooth as the other's stop
inline constexpr double exponential_ratio_max = 1000.0;
Filter exponential(int order, double ratio);

/// Gaussian exp(-(alpha x)^2/2), x = (i - N/2)/(N/2) from -1 to 1. order >= 1.
/// @param alpha  half width over standard deviation, 0 <= alpha <= 6; 0 is the boxcar
Filter gaussian(int order, double alpha);

/// Moving averages one after another: the convolution of boxcars of these many taps; N = sum (length - 1). Of two: a
/// trapezoid.
/// @param lengths  at least one, each >= 1
Filter averages(std::span<const int> lengths);

/// The taps of such a cascade followed by pairs (with_pairs) before they are divided by their sum, which is
/// 2^pairs times the product of the lengths: whole numbers.
std::vector<double> cascade_taps(std::span<const int> lengths, int pairs, int delay);

/// A filter followed by equal impulses `delay` samples apart, which cancel an undamped vibration of period 2 delay T.
/// @param pairs  how many pairs (1/2 now, 1/2 after the delay): 1 is the ZV shaper of two impulses, 2 the ZVD of three
///               (Singer and Seering, J. Dyn. Sys. Meas. Control 112, 1990), 0 leaves the filter as it is; 0 to 2
/// @param delay  samples, >= 1; each pair makes the order larger by it
Filter with_pairs(const Filter& filter, int pairs, int delay);

}  // namespace accdec
