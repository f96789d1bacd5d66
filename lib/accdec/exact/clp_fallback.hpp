#pragma once

#include <functional>
#include <vector>

#include <accdec/exact/dual_simplex.hpp>

namespace accdec::exact {

/// Result of a linear program, in the terms of `DualSimplex`.
struct LpSolution {
  DualSimplex::Status status = DualSimplex::Status::trouble;
  double objective = 0.0;
  std::vector<double> point, multipliers;
};

/// Solves a linear program with Clp, from the start. It is used for the few programs where the dense
/// tableau loses its digits.
/// @param stop  polled between iterations; may be empty
/// @throws std::runtime_error if Clp's module cannot be loaded (solvers/module.hpp)
LpSolution solve_by_clp(const LpRows& lp, const std::function<bool()>& stop);

}  // namespace accdec::exact

/// In Clp's module.
extern "C" void accdec_solve_by_clp(const accdec::exact::LpRows& lp, const std::function<bool()>& stop,
                                    accdec::exact::LpSolution& solution);
