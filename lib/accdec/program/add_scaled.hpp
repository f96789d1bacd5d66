#pragma once

#include <cstdint>

namespace accdec {

/// y[i] += a x[i] for i = 0 .. n - 1. Uses AVX2 where the processor has it.
void add_scaled(double* y, double a, const double* x, std::int64_t n);

}  // namespace accdec
