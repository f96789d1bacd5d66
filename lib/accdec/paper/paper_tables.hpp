#pragma once

#include <string>
#include <vector>

namespace accdec::paper {

/// One entry of Table 1 or 2, printed and recomputed.
struct Entry {
  int feed_in = 0;         ///< v1, 1e5 BLU/s
  int feed_out = 0;        ///< v2 = 3 v1, 1e5 BLU/s
  int delay = 0;           ///< dT/T, samples
  int printed = 0;         ///< BLU
  double formula = 0.0;    ///< corner error by the closed forms (Table 1) or the blend formulas (Table 2), BLU
  double simulated = 0.0;  ///< the same by plain convolution of the command stream, BLU
  /// Both ways round to the printed number. Halves round up.
  bool agrees() const;
  /// Distance of the formula's value from the nearest half BLU, where rounding could go either way; 0 .. 0.5.
  double tie_distance() const;
};

struct Table {
  std::string name;  ///< "table1", "table2"
  std::string title;
  std::vector<int> delays;     ///< samples, one a column
  std::vector<Entry> entries;  ///< row by row: 5 feeds x 4 delays
  int disagreements() const;
};

/// Table 1: linear Acc/Dec. The error is the minimum over t = kT of the exact continuous motion. The simulation uses 41
/// equal taps and the trapezoidal rule, which is exact for a speed that is linear between samples.
Table table1();
/// Table 2: FIR Acc/Dec, the minimum over samples of the right-rectangle sum (Eq. 29). The delays of its header are not
/// printed.
Table table2();

/// Largest difference between formula and simulation over a table, relative to the largest entry; rounding only, below
/// 1e-12.
double formula_simulation_difference(const Table& table);

}  // namespace accdec::paper
