#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include <accdec/exact/lp_answer.hpp>
#include <accdec/exact/ratio_test.hpp>
#include <accdec/exact/tableau.hpp>

namespace accdec::exact {

/// Linear program
///
///   minimise cost x   subject to   low <= x <= high,   row_low <= A x <= row_high
///
/// solved by the bounded dual simplex method on a dense tableau. It is made for the linear programs of the exact
/// method: they have 20 to 300 columns, nearly all bounded. Many of their rows are dense or have few entries, and about
/// a hundred similar programs follow one another. Rows can be added, replaced and removed, and bounds changed, at any
/// time. The next solve starts from the basis of the last (Tableau). Bounds may be infinite or equal.
///
/// Leaving rows are chosen by steepest edge (Forrest and Goldfarb, Math. Program. 57, 1992). The weights are norms of
/// tableau rows and are computed each time. Entering columns are chosen by the bound flipping ratio test (RatioTest). A
/// point or a ray is returned only after it was checked against the rows as given (LpAnswer).
class DualSimplex {
 public:
  enum class Status {
    optimal,
    infeasible,  ///< `multipliers` is a Farkas ray
    unbounded,
    stopped,
    trouble  ///< rounding got the better of it, or the basis cannot be started from
  };
  static constexpr double infinity = LpRows::infinity;
  static constexpr double primal_tolerance = LpAnswer::tolerance;  ///< on bounds of columns and rows, absolute

  /// Columns with cost 0 and bounds 0 .. infinity.
  explicit DualSimplex(int columns);

  int columns() const { return given().columns(); }
  int rows() const { return given().rows(); }
  void set_cost(int column, double cost) { basis_.set_cost(column, cost); }
  void set_column_bounds(int column, double low, double high) { basis_.set_bounds(column, low, high); }
  void set_row_bounds(int row, double low, double high) { basis_.set_bounds(columns() + row, low, high); }
  /// @param columns  each at most once
  void add_row(std::span<const int> columns, std::span<const double> values, double low, double high);
  /// Gives a row other coefficients and bounds; an active row stays active where that is safe.
  void replace_row(int row, std::span<const int> columns, std::span<const double> values, double low, double high);
  /// Removes a row. The last row takes its number.
  void remove_row(int row);
  /// Polled every few pivots; true ends a solve with `stopped`.
  void set_stop(std::function<bool()> stop) { stop_ = std::move(stop); }

  /// Forgets the basis.
  void start_cold() { basis_.start_cold(); }
  Status solve();

  double objective() const { return answer_.objective(); }
  /// optimal: the point.
  std::span<const double> point() const { return answer_.point(); }
  /// One per row, y_r > 0 for the lower side and < 0 for the upper. Optimal: derivative of the objective by the row's
  /// bound. Infeasible: for all x within their bounds, the sum y_r (A x)_r stays below the sum of y_r times the
  /// matching sides.
  std::span<const double> multipliers() const { return answer_.multipliers(); }
  /// Whether the row holds with equality in the basis.
  bool active(int row) const { return !basis_.is_basic(columns() + row); }
  long pivots() const { return basis_.pivots(); }
  /// The program as given, for a second solver.
  const LpRows& given() const { return basis_.given(); }

 private:
  enum At : std::uint8_t { lower, upper, free, far_below, far_above };  // the last two: where no bound of its own is
  Status attempt();
  Status iterate();
  void compute_duals();
  void settle_nonbasics();
  void compute_basics();
  bool dual_feasible() const;
  int leaving_variable();
  int entering_position(const double* row, double sigma, double infeasibility);
  void flip();
  void step(int leaving, const double* row, int position, double sigma);
  void reset_wrong_duals();
  void perturb();

  Tableau basis_;
  LpAnswer answer_;
  std::vector<double> value_;  ///< by variable
  std::vector<At> at_;         ///< by variable, of nonbasics
  std::vector<double> dual_;   ///< by position: reduced costs
  bool moved_ = false;         ///< reduced costs were moved from their own values
  RatioTest ratio_test_{primal_tolerance};
  std::vector<int> flips_;
  std::vector<double> scratch_;  ///< by position
  std::function<bool()> stop_;
  std::uint32_t random_ = 1;
};

}  // namespace accdec::exact
