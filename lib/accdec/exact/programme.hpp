#pragma once

#include <functional>
#include <vector>

#include <coin/ClpSimplex.hpp>

#include <accdec/exact/rows.hpp>

// Internal to the exact method: the rows of its linear programme.

namespace accdec::exact {

/// Limits are met to within this in the programme, well inside the verifier's 1e-9, so that a limit used to its very
/// last bit does not fall between a solution that verifies and a refutation.
inline constexpr double slack = 3e-10;

/// Linear programme over the taps b_0 .. b_N of the largest order, the excess over the cones (minimised) and, where
/// limits need them, the cumulative responses. Its first rows hold for every box; cuts follow.
class Programme {
 public:
  /// @param margin  > 0: every limit is asked for with this relative margin instead of the slack
  Programme(const LimitModel& model, int largest_order, const std::function<bool()>& stop, double margin);

  /// Rows of the last box go; its cuts come again at their angles in the new box.
  void prepare(const Box& box, bool symmetric);
  /// Forgets basis and cuts: rounding piles up from one warm start to the next.
  void start_cold();
  /// After `prepare`: asks for no margin of the cones, and adds tangents that the excess may break.
  void soften(const std::vector<RowId>& close, const Filter& at, const Box& box);
  /// Adds what the filter breaks. False: nothing new. @param allowed  excess over the cones
  bool cut(const Filter& filter, const Box& box, double allowed);
  /// Taps of the current solution.
  Filter filter(const Box& box, bool symmetric) const;
  /// Duals (of either sign) as multipliers of the rows' limits; equations have no part in a proof.
  Multipliers multipliers(const double* dual, double sign, const Box& box);
  /// Duals of the least sum by which the rows have to be broken; empty if that cannot be solved.
  std::vector<double> least_infeasibility() const;
  /// Of the current solution and corner j: d - d1, and k - k1 in the same units.
  double delay(std::size_t j) const { return lp_.primalColumnSolution()[delay_column(j)]; }
  double sample(std::size_t j) const { return lp_.primalColumnSolution()[delay_column(j) + 1]; }
  const LimitModel& model() const { return model_; }
  ClpSimplex& lp() { return lp_; }

 private:
  int excess() const { return largest_ + 1; }
  int sum_column(int k) const { return largest_ + 1 + k; }  // B_k, k >= 1
  double broken() const { return slack_ + slack; }          // as far beyond its row a limit counts as broken
  double vibration_scale(const RowId& id) const;
  void add(const std::vector<int>& columns, const std::vector<double>& values, double low, double high,
           const RowId& id);
  void add_base_rows();
  void add_row(const RowId& id, const SparseRow& row, bool both, bool soft = false);
  bool add_sparse(const RowId& id, const Box& box);
  void add_cone(std::size_t j, double angle, const Box& box);
  void add_range_cone(const RowId& id, const Box& box);
  void prepare_ranges(const Box& box, const std::vector<RowId>& old);
  void cut_ranges(std::size_t j, const Filter& filter, const Box& box, double allowed, bool& added);
  bool known_cone(const RowId& id) const;
  bool shared(std::size_t j, const Box& box) const { return box.budget && box.ranges(j); }
  int delay_column(std::size_t j) const { return columns_ - 2 * static_cast<int>(model_.corners() - j); }
  void add_vibration(const RowId& id);
  bool cut_cones(const Filter& filter, const Box& box, double allowed);
  bool cut_vibration(const Filter& filter, const Box& box);

  const LimitModel& model_;
  int largest_, columns_, base_rows_ = 0;
  double slack_;
  double least_ = 0.0;  // no more margin than this is asked of the cones
  ClpSimplex lp_;
  std::vector<RowId> ids_;
  std::vector<RowId> vibration_;
};

}  // namespace accdec::exact
