#pragma once

#include <cstdint>

namespace accdec {

/// Values that the functions here may read and write past the ends that are given.
inline constexpr std::int64_t convolve_margin = 64;

/// y[i] += a x[i] for i = 0 .. n - 1, and a times what follows in x to as many of y as fill its last eight.
void add_scaled(double* y, double a, const double* x, std::int64_t n);

/// y[j] += sum_i taps[i] x[j - i], i = 0 .. count - 1, for j = 0 .. n - 1: the plain convolution, every product of its
/// own. x is readable from x[1 - count] on; at both ends x and y are readable, y writable, convolve_margin further than
/// said. What is added to y there is that convolution, too.
void add_convolved(double* y, const double* x, std::int64_t n, const double* taps, std::int64_t count);

/// Samples whose changes are counted together.
inline constexpr std::int64_t change_window = 32;

/// change[k] = u[k] - u[k - 1] for k = 0 .. n - 1, and zeros up to the end of the last window; changes[w] is how many
/// of window w = 0 .. (n - 1) / change_window are not zero. At both ends u is readable for a window more.
void find_changes(const double* u, std::int64_t n, double* change, std::uint8_t* changes);

}  // namespace accdec
