#pragma once

#include <functional>
#include <vector>

#include <accdec/exact/dual_simplex.hpp>

namespace accdec::exact {

/// What a linear program came to, in the terms of `DualSimplex`.
struct LpSolution {
  DualSimplex::Status status = DualSimplex::Status::trouble;
  double objective = 0.0;
  std::vector<double> point, multipliers;
};

/// Solves the linear program as given to `lp` with Clp, from the start: for the few where the dense tableau loses its
/// digits.
/// @param stop  polled between iterations; may be empty
LpSolution solve_by_clp(const DualSimplex& lp, const std::function<bool()>& stop);

}  // namespace accdec::exact
