#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

// Internal to the dual simplex method.

namespace accdec::exact {

/// A linear program as given: minimise cost x subject to low <= x <= high, row_low <= A x <= row_high. Variables are
/// the columns, then the values of the rows.
class LpRows {
 public:
  static constexpr double infinity = std::numeric_limits<double>::infinity();

  /// Columns with cost 0 and bounds 0 .. infinity.
  explicit LpRows(int columns);

  int columns() const { return columns_; }
  int rows() const { return static_cast<int>(rows_.size()); }
  int variables() const { return columns_ + rows(); }
  double cost(int column) const { return cost_[static_cast<std::size_t>(column)]; }
  double low(int variable) const { return low_[static_cast<std::size_t>(variable)]; }
  double high(int variable) const { return high_[static_cast<std::size_t>(variable)]; }
  bool fixed(int variable) const { return low(variable) == high(variable); }
  std::span<const int> row_columns(int row) const { return rows_[static_cast<std::size_t>(row)].columns; }
  std::span<const double> row_values(int row) const { return rows_[static_cast<std::size_t>(row)].values; }
  /// Whether a row has few entries.
  bool is_short(int row) const { return rows_[static_cast<std::size_t>(row)].columns.size() <= most_short; }

  void set_cost(int column, double cost) { cost_[static_cast<std::size_t>(column)] = cost; }
  void set_bounds(int variable, double low, double high);
  void add_row(std::span<const int> columns, std::span<const double> values, double low, double high);
  /// False: the row has these coefficients already.
  bool replace_row(int row, std::span<const int> columns, std::span<const double> values);
  /// The last row takes the number of the one removed.
  void remove_row(int row);

  /// A row's value. @param x  values of the columns, and perhaps of more
  double activity(int row, std::span<const double> x) const;
  /// The same of a short row, for loops over all of them.
  double short_activity(int row, const double* x) const {
    const ShortRow& r = short_rows_[static_cast<std::size_t>(row)];
    double sum = 0.0;
    for (std::size_t e = 0; e < r.size; ++e) sum += r.values[e] * x[r.columns[e]];
    return sum;
  }
  /// A bound slightly below the least value of a variable that the columns' bounds allow; no solution lies there. At
  /// most `far` away, which stands for infinite.
  double least_activity(int variable, double far) const;
  double most_activity(int variable, double far) const;
  /// Whether a ray proves that no point holds all bounds. Entries meant for an infinite side are set to 0.
  bool refutes(std::vector<double>& ray) const;

 private:
  static constexpr std::size_t most_short = 4;
  struct Row {
    std::vector<int> columns;
    std::vector<double> values;
  };
  /// The same of a short row, in place.
  struct ShortRow {
    std::array<int, most_short> columns{};
    std::array<double, most_short> values{};
    std::size_t size = 0;
  };
  void set_row(int row, std::span<const int> columns, std::span<const double> values);

  int columns_;
  std::vector<double> cost_, low_, high_;
  std::vector<Row> rows_;
  std::vector<ShortRow> short_rows_;  ///< by row
};

}  // namespace accdec::exact
