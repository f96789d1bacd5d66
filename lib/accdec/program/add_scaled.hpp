#pragma once

#include <cstdint>

namespace accdec {

/// y[i] += a x[i] for i = 0 .. n - 1. Uses AVX2 where the processor has it.
void add_scaled(double* y, double a, const double* x, std::int64_t n);

/// y[m] += a[0] x[m] + a[1] x[m-1] + a[2] x[m-2] + a[3] x[m-3] for m = 0 .. n - 1, and perhaps 0 to the next 3 of y: four steps of a
/// command on consecutive samples at once. x[-3] .. x[n + 2] must be readable, y[0] .. y[n + 2] writable.
void add_scaled4(double* y, const double* a, const double* x, std::int64_t n);

}  // namespace accdec
