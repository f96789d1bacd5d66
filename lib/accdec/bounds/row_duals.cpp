#include <coin/ClpSimplex.hpp>

#include <accdec/bounds/row_duals.hpp>

void accdec_row_duals(const accdec::RowProgram& program, std::vector<double>& duals) {
  const auto rows = static_cast<int>(program.row_low.size());
  const CoinPackedMatrix matrix(false, program.columns, rows, static_cast<CoinBigIndex>(program.index.size()),
                                program.value.data(), program.index.data(), program.start.data(), nullptr);
  ClpSimplex lp;
  lp.setLogLevel(0);
  // Rows are scaled already; Clp's own scaling ends with duals that do not hold for the rows as they are.
  lp.scaling(0);
  lp.loadProblem(matrix, program.low.data(), program.high.data(), program.costs.data(), program.row_low.data(),
                 program.row_high.data());
  // Not seconds: the bound must not depend on how fast the machine is.
  lp.setMaximumIterations(20'000);
  lp.dual();
  duals.clear();
  if (const double* dual = lp.dualRowSolution(); dual != nullptr) duals.assign(dual, dual + rows);
}
