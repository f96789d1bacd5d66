#pragma once

#include <span>
#include <string>
#include <vector>

#include <accdec/problem.hpp>

namespace accdec::nlp {

/// One derivative that differs from finite differences.
struct WrongDerivative {
  enum class Kind { gradient, jacobian, hessian, residual_jacobian };
  Kind kind = Kind::gradient;
  int row = -1;    ///< row of the Jacobian, residual, or first variable of a second derivative; -1 for the gradient
  int column = 0;  ///< variable
  double analytic = 0.0;
  double numeric = 0.0;
  /// For example "Jacobian of row force x by B_3: 2 given, 4 found".
  std::string text;
};

/// Compares every first and second derivative of a problem, also outside the sparsity patterns, with central
/// differences. These are extrapolated from two steps (error O(h^4)). Hessians are compared with differences of the
/// given first derivatives, at fixed pseudo-random multipliers. O(n) evaluations of everything. A derivative may jump
/// within a step of x: second derivatives of interpolated functions jump at the knots. Then the derivative of either
/// side is right, so an entry that differs is also compared with one-sided differences.
/// @param x          size n, in the interior of the domain by more than `step`
/// @param tolerance  relative to the larger of 1, the entry, and the largest value of the function differentiated
/// @param step       relative to max(1, |x_i|)
/// @throws std::invalid_argument if x has the wrong size.
std::vector<WrongDerivative> check_derivatives(const Problem& problem, std::span<const double> x,
                                               double tolerance = 1e-6, double step = 1e-4);

}  // namespace accdec::nlp
