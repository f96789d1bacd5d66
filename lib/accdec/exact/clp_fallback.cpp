#include <accdec/exact/clp_fallback.hpp>
#include <accdec/solvers/module.hpp>

namespace accdec::exact {

LpSolution solve_by_clp(const LpRows& lp, const std::function<bool()>& stop) {
  static auto* const solve = solvers::module_function<decltype(accdec_solve_by_clp)>("clp", "accdec_solve_by_clp");
  LpSolution solution;
  solve(lp, stop, solution);
  return solution;
}

}  // namespace accdec::exact
