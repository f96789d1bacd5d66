#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include <accdec/exact/ratio_test.hpp>

namespace accdec::exact {

/// Linear program
///
///   minimise cost x   subject to   low <= x <= high,   row_low <= A x <= row_high
///
/// solved by the bounded dual simplex method on a dense tableau. It is made for the linear programs of the exact
/// method: they have 20 to 300 columns, nearly all bounded. Many of their rows are dense or have few entries, and about
/// a hundred similar programs follow one another. The tableau has no rows for inactive rows of few entries, as the
/// columns hold the same information. Rows can be added, replaced and removed, and bounds changed, at any time. The
/// next solve starts from the basis of the last. Bounds may be infinite or equal.
///
/// Leaving rows are chosen by steepest edge (Forrest and Goldfarb, Math. Program. 57, 1992). The weights are norms of
/// tableau rows and are computed each time. Entering columns are chosen by the bound flipping ratio test (RatioTest). A
/// point or a ray is returned only after it was checked against the rows as given.
class DualSimplex {
 public:
  enum class Status {
    optimal,
    infeasible,  ///< `multipliers` is a Farkas ray
    unbounded,
    stopped,
    trouble  ///< rounding got the better of it, or the basis cannot be started from
  };
  static constexpr double infinity = std::numeric_limits<double>::infinity();
  static constexpr double primal_tolerance = 1e-10;  ///< on bounds of columns and rows, absolute

  /// Columns with cost 0 and bounds 0 .. infinity.
  explicit DualSimplex(int columns);

  int columns() const { return columns_; }
  int rows() const { return static_cast<int>(rows_.size()); }
  void set_cost(int column, double cost);
  void set_column_bounds(int column, double low, double high);
  void set_row_bounds(int row, double low, double high);
  /// @param columns  each at most once
  void add_row(std::span<const int> columns, std::span<const double> values, double low, double high);
  /// Gives a row other coefficients and bounds; an active row stays active where that is safe.
  void replace_row(int row, std::span<const int> columns, std::span<const double> values, double low, double high);
  /// Removes a row. The last row takes its number.
  void remove_row(int row);
  /// Polled every few pivots; true ends a solve with `stopped`.
  void set_stop(std::function<bool()> stop) { stop_ = std::move(stop); }

  /// Forgets the basis.
  void start_cold();
  Status solve();

  double objective() const { return objective_; }
  /// optimal: the point.
  std::span<const double> point() const { return point_; }
  /// One per row, y_r > 0 for the lower side and < 0 for the upper. Optimal: derivative of the objective by the row's
  /// bound. Infeasible: for all x within their bounds, the sum y_r (A x)_r stays below the sum of y_r times the
  /// matching sides.
  std::span<const double> multipliers() const { return multipliers_; }
  /// Whether the row holds with equality in the basis.
  bool active(int row) const { return slot_[static_cast<std::size_t>(columns_ + row)] < 0; }
  /// Whether a ray proves that no point holds all bounds. Entries meant for an infinite side are set to 0.
  bool refutes(std::vector<double>& ray) const;
  long pivots() const { return pivots_; }

  // The program as given, for a second solver.
  double cost(int column) const { return cost_[static_cast<std::size_t>(column)]; }
  double low(int variable) const { return low_[static_cast<std::size_t>(variable)]; }  ///< columns, then rows
  double high(int variable) const { return high_[static_cast<std::size_t>(variable)]; }
  std::span<const int> row_columns(int row) const { return rows_[static_cast<std::size_t>(row)].columns; }
  std::span<const double> row_values(int row) const { return rows_[static_cast<std::size_t>(row)].values; }

 private:
  enum At : std::uint8_t { lower, upper, free, far_below, far_above };  // the last two: where no bound of its own is
  static constexpr std::size_t most_short = 4;
  static constexpr int unstored = std::numeric_limits<int>::max();
  struct Row {
    std::vector<int> columns;
    std::vector<double> values;
    bool is_short = false;
  };
  /// The same of a short row, in place.
  struct ShortRow {
    std::array<int, most_short> columns{};
    std::array<double, most_short> values{};
    std::size_t size = 0;
  };
  double* tableau_row(int i) { return tableau_.data() + static_cast<std::size_t>(i) * stride_; }
  const double* tableau_row(int i) const { return tableau_.data() + static_cast<std::size_t>(i) * stride_; }
  double activity(int row, const std::vector<double>& x) const;
  void set_row(int row, std::span<const int> columns, std::span<const double> values);
  bool is_stored(int variable) const;
  void make_basic(int row);
  void express(int row, double* in_nonbasics) const;
  const double* in_nonbasics(int basic);
  double entry(int basic, int position) const;
  void eliminate(const double* row, int position, int but);
  void exchange(int out, const double* row, int position);
  bool free_row(int row);
  int append_tableau_row(int basic);
  void drop_tableau_row(int i);
  double least_activity(int variable) const;
  double most_activity(int variable) const;
  void refactor();
  void compute_duals();
  void settle_nonbasics();
  void compute_basics();
  void compute_unstored();
  Status attempt();
  Status iterate();
  bool dual_feasible();
  int leaving_variable();
  int entering_position(const double* row, double sigma, double infeasibility);
  void flip();
  void step(int leaving, const double* row, int position, double sigma);
  void perturb();
  bool take_point();
  bool take_ray(int leaving, const double* row, double sigma);

  int columns_;
  std::size_t stride_;
  std::vector<double> cost_, low_, high_;
  std::vector<Row> rows_;
  std::vector<ShortRow> short_rows_;  ///< by row

  // Basic variables in terms of the nonbasic ones; variables are the columns, then the values of the rows.
  std::vector<double> tableau_;
  std::vector<int> basic_;      ///< by row of the tableau; short rows of the program are not in it
  std::vector<int> nonbasic_;   ///< by position
  std::vector<int> slot_;       ///< by variable: row of the tableau, `unstored`, or -1 - position among the nonbasics
  std::vector<double> value_;   ///< by variable
  std::vector<At> at_;          ///< by variable, of nonbasics
  std::vector<double> dual_;    ///< by position: reduced costs
  std::vector<double> is_row_;  ///< by position: 1 for a row, 0 for a column
  bool moved_ = false;          ///< reduced costs were moved from their own values

  RatioTest ratio_test_{primal_tolerance};
  std::vector<int> flips_;
  std::vector<double> scratch_values_, expressed_, pivot_row_;
  std::vector<std::pair<int, double>> scratch_;
  std::function<bool()> stop_;
  long pivots_ = 0;
  std::uint32_t random_ = 1;
  double objective_ = 0.0;
  std::vector<double> point_, multipliers_;
};

}  // namespace accdec::exact
