#pragma once

#include <utility>
#include <vector>

namespace accdec {

/// A linear program of a bound: rows low <= A x <= high over columns in ranges of their own. Only its multipliers are
/// used, so that nothing rests on the solver's word.
class BoundRows {
 public:
  explicit BoundRows(int columns) : columns_(columns) {}
  /// Columns may stand more than once in a row.
  void add(const std::vector<std::pair<int, double>>& entries, double low, double high);
  /// No upper side.
  static constexpr double none = 1e30;

  /// For every x within the rows: costs x >= sides + sum of (costs - part)_j x_j.
  struct Multipliers {
    double sides = 0.0;        ///< the multipliers times the sides of their rows that their signs name
    std::vector<double> part;  ///< the multipliers' part in every column
    /// The least that this leaves of costs x with columns in [low, high].
    double least(const std::vector<double>& costs, const std::vector<double>& low,
                 const std::vector<double>& high) const;
  };
  /// Those of the least costs x with columns in [low, high]; valid whatever the solver ends with, and zeros if it
  /// fails.
  /// @throws std::runtime_error if Clp's module cannot be loaded (solvers/module.hpp)
  Multipliers multipliers(const std::vector<double>& costs, const std::vector<double>& low,
                          const std::vector<double>& high) const;

 private:
  int columns_;
  std::vector<std::vector<std::pair<int, double>>> rows_;
  std::vector<double> low_, high_;
};

}  // namespace accdec
