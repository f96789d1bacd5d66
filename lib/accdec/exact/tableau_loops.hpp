#pragma once

#include <cstddef>

// Internal to the dual simplex method: its loops over rows of the tableau, four numbers at a time where the processor
// has AVX2. Sums are always added in the same order, so that answers do not depend on the processor.

namespace accdec::exact {

/// to += factor from. @param size  of all these: a multiple of 4
void add_multiple(double* to, const double* from, double factor, std::size_t size);
double dot(const double* a, const double* b, std::size_t size);
/// sum_j weights_j x_j^2
double sum_of_squares(const double* weights, const double* x, std::size_t size);
/// Adds to every row except `but` the pivot row times the row's entry at a position, which is set to 0.
/// @param but  the row left out; -1: none
void add_multiples_of_row(double* rows, std::size_t count, std::size_t size, const double* pivot_row,
                          std::size_t position, int but);

}  // namespace accdec::exact
