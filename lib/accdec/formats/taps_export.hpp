#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <accdec/task/result.hpp>

namespace accdec {

/// Formats of `export_taps`.
inline constexpr std::string_view taps_formats[] = {"csv", "c", "json", "npy", "cascade"};

/// A design's taps for a controller or another tool, as the bytes of a file:
///   csv      a header line and "i,b_i" lines
///   c        a header with the order, the sample period and a double array
///   json     order, sample period, taps, delays
///   npy      NumPy 1.0 file of N + 1 little-endian float64
///   cascade  JSON with the lengths of moving averages whose cascade is this filter
/// @throws std::invalid_argument for an unknown format, a result without a filter, or taps that are no cascade of
/// moving averages.
std::string export_taps(const DesignResult& result, std::string_view format);

/// Lengths (>= 2, descending) of moving averages whose convolution is the filter to within `tolerance` of its largest
/// tap; empty when it is none. Zero taps at the ends are allowed; {} also for a single tap. At most three averages are
/// tried.
std::vector<int> moving_average_cascade(const Filter& filter, double tolerance = 1e-9);

}  // namespace accdec
