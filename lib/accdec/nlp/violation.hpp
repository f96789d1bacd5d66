#pragma once

#include <span>

#include <accdec/problem.hpp>

namespace accdec::nlp {

/// Largest absolute violation of any variable's or row's bound at x, 0 where all hold; infinite where a variable or row
/// is not finite.
/// @param x  size num_variables
double largest_violation(const Problem& problem, std::span<const double> x);

/// Whether one objective is better than another by more than tolerances and rounding explain: 1e-6 of max(1, |other|).
bool materially_better(double objective, double other);

}  // namespace accdec::nlp
