#pragma once

#include <cstddef>

// Internal to the dual simplex method: its loops over rows of the tableau, four numbers at a time where the processor
// has AVX2. Sums are added up in the same order everywhere, so that answers do not depend on the processor.

namespace accdec::exact {

/// to += factor from. @param size  of all these: a multiple of 4
void add_multiple(double* to, const double* from, double factor, std::size_t size);
double dot(const double* a, const double* b, std::size_t size);
/// sum_j weights_j x_j^2
double sum_of_squares(const double* weights, const double* x, std::size_t size);
/// Adds to every row but one the pivot row times what the row has at a position, which is taken away.
/// @param but  no row: of none but
void add_multiples_of_row(double* rows, std::size_t count, std::size_t size, const double* pivot_row,
                          std::size_t position, int but);

}  // namespace accdec::exact
