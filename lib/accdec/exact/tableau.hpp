#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include <accdec/exact/lp_rows.hpp>

// Internal to the dual simplex method.

namespace accdec::exact {

/// A linear program and a basis of it: basic variables in terms of the nonbasic ones. Rows of few entries have no row
/// of the tableau while they are basic ("unstored"), as the columns hold the same information. Rows of the program can
/// be added, replaced and removed at any time.
class Tableau {
 public:
  explicit Tableau(int columns);

  const LpRows& given() const { return given_; }
  void set_cost(int column, double cost) { given_.set_cost(column, cost); }
  void set_bounds(int variable, double low, double high) { given_.set_bounds(variable, low, high); }
  void add_row(std::span<const int> columns, std::span<const double> values, double low, double high);
  /// Gives a row other coefficients; a nonbasic row stays nonbasic where that is safe.
  void replace_row(int row, std::span<const int> columns, std::span<const double> values);
  /// The last row takes the number of the one removed.
  void remove_row(int row);

  /// Forgets the basis: all rows become basic.
  void start_cold();
  /// Rebuilds the tableau from the rows as given, for the same basis or, if that is singular, one near it.
  void refactor();

  bool is_basic(int variable) const { return slot_[static_cast<std::size_t>(variable)] >= 0; }
  /// Whether the variable is a basic row without a row of the tableau.
  bool is_unstored(int variable) const { return slot_[static_cast<std::size_t>(variable)] == unstored; }
  /// By row of the tableau.
  std::span<const int> basic() const { return basic_; }
  int nonbasic(int position) const { return nonbasic_[static_cast<std::size_t>(position)]; }
  /// Numbers in a row of the tableau: the columns, and zeros up to a multiple of 4.
  std::size_t width() const { return width_; }
  const double* entries(int i) const { return entries_.data() + static_cast<std::size_t>(i) * width_; }
  /// A basic variable's row of the tableau, until the next change of it.
  const double* in_nonbasics(int basic);
  /// sum of the squares of a basic variable's row at the positions of nonbasic rows
  double square_in_rows(int basic);
  /// A basic variable, with its row, for the nonbasic one at a position.
  void exchange(int out, const double* row, int position);
  /// Computes the values of the unstored rows from the columns' values. @param value  by variable
  void compute_unstored(std::vector<double>& value) const;
  long pivots() const { return pivots_; }

 private:
  static constexpr int unstored = std::numeric_limits<int>::max();
  double* writable(int i) { return entries_.data() + static_cast<std::size_t>(i) * width_; }
  bool is_stored(int variable) const;
  void make_basic(int row);
  void express(int row, double* in_nonbasics) const;
  double entry(int basic, int position) const;
  void eliminate(const double* row, int position, int but);
  bool free_row(int row);
  int append(int basic);
  void drop(int i);

  LpRows given_;
  std::size_t width_;
  std::vector<double> entries_;
  std::vector<int> basic_;      ///< by row of the tableau
  std::vector<int> nonbasic_;   ///< by position
  std::vector<int> slot_;       ///< by variable: row of the tableau, `unstored`, or -1 - position among the nonbasics
  std::vector<double> is_row_;  ///< by position: 1 for a row, 0 for a column
  std::vector<double> expressed_, pivot_row_;
  long pivots_ = 0;
};

}  // namespace accdec::exact
