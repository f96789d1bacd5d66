#pragma once

#include <vector>

namespace accdec {

/// A linear program: the least costs x with row_low <= A x <= row_high and low <= x <= high.
struct RowProgram {
  int columns = 0;
  std::vector<int> start, index;  ///< A by rows: row r has the entries from start[r] to start[r + 1]
  std::vector<double> value;
  std::vector<double> costs, low, high, row_low, row_high;
};

}  // namespace accdec

/// In Clp's module. One dual per row; empty if Clp has none.
extern "C" void accdec_row_duals(const accdec::RowProgram& program, std::vector<double>& duals);
