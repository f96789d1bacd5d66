#pragma once

#include <cstdint>

namespace accdec {

/// Number of values that the functions here may read and write past the given ends.
inline constexpr std::int64_t convolve_margin = 64;

/// y[i] += a x[i] for i = 0 .. n - 1. The values after them in y, up to a full group of eight, get a times the further
/// values of x.
void add_scaled(double* y, double a, const double* x, std::int64_t n);

/// y[j] += sum_i taps[i] x[j - i], i = 0 .. count - 1, for j = 0 .. n - 1: the plain convolution, product by product. x
/// must be readable from x[1 - count] on. At both ends, x and y must be readable, and y writable, convolve_margin
/// further. The values added to y there are also this convolution.
void add_convolved(double* y, const double* x, std::int64_t n, const double* taps, std::int64_t count);

/// Samples whose changes are counted together.
inline constexpr std::int64_t change_window = 32;

/// Computes change[k] = u[k] - u[k - 1] for k = 0 .. n - 1, and zeros up to the end of the last window. The values of
/// window w = 0 .. (n - 1) / change_window that are not zero are counted in changes[w]. At both ends u must be readable
/// for one more window.
void find_changes(const double* u, std::int64_t n, double* change, std::uint8_t* changes);

}  // namespace accdec
