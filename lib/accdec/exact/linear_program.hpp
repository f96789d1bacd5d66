#pragma once

#include <functional>
#include <vector>

#include <accdec/exact/clp_fallback.hpp>
#include <accdec/exact/dual_simplex.hpp>
#include <accdec/exact/limit_model.hpp>
#include <accdec/exact/relaxation.hpp>
#include <accdec/exact/row_drafts.hpp>
#include <accdec/exact/row_names.hpp>

// Internal to the exact method: its linear program.

namespace accdec::exact {

/// rad; two cuts whose angles differ by less are the same within the linear program's tolerance.
inline constexpr double same_angle = 1e-11;

/// Linear program over the taps b_0 .. b_N of the largest order and the excess over the cones, which is minimised. Its
/// first rows hold for every box; cuts follow. Cumulative responses are written as sums of taps, because the tableau is
/// dense anyway.
class LinearProgram {
 public:
  /// @param margin  not 0: every limit gets this relative margin instead of the slack
  /// @param kind  of the boxes to come
  LinearProgram(const LimitModel& model, int largest_order, const std::function<bool()>& stop, double margin,
                BoxKind kind);

  /// Keeps the last box's cuts that held its solution, with their coefficients in the new box, and removes the others.
  void prepare(const Box& box, bool symmetric);
  /// Forgets basis and cuts, as rounding adds up from one warm start to the next.
  void start_cold();
  /// From now on solves by Clp alone, or by the dense dual simplex first.
  void use_clp_alone(bool alone) { kind_.clp_alone = alone; }
  /// Call after `prepare`. The cones get no margin, and tangents are added that the excess may break.
  void soften(const std::vector<Chord>& close, const Filter& at, const Box& box);
  /// The same, but nothing may break the tangents.
  void tie(const std::vector<Chord>& close, const Filter& at, const Box& box);
  /// Solves it as it stands, by the dense dual simplex, or by Clp where that loses its digits.
  const LpSolution& solve();
  /// Adds cuts that the filter breaks. False: nothing new. @param allowed  excess over the cones
  bool cut(const Filter& filter, const Box& box, double allowed);
  /// Taps of the current solution.
  Filter filter(const Box& box, bool symmetric) const;
  /// Whether delays and samples are columns, as boxes with a budget need them.
  bool has_ranges() const { return kind_.ranges; }
  /// d - d1 and k - k1 of corner j in the current solution, in the same units.
  double delay(std::size_t j) const { return solution_.point[static_cast<std::size_t>(drafts_.delay_column(j))]; }
  double sample(std::size_t j) const { return solution_.point[static_cast<std::size_t>(drafts_.sample_column(j))]; }
  /// Duals of the current solution as multipliers of the rows' limits. Equations have no part in a proof.
  Multipliers multipliers() const;
  long pivots() const { return lp_.pivots(); }

 private:
  double broken() const { return slack_ + slack; }  // a limit counts as broken if it exceeds its row by more than this
  double tap_bound(int column) const;
  void add(const DraftRow& row, RowName name);
  void add_tangents(const std::vector<Chord>& close, const Filter& at, const Box& box, double least_use, bool soft);
  void add_base_rows();
  void add_cone(std::size_t j, double angle, const Box& box);
  void add_contours(std::size_t j, const Box& box);
  void prepare_ranges(const Box& box);
  void cut_ranges(std::size_t j, const Filter& filter, const Box& box, double allowed, bool& added);
  bool add_limit(const proof::Row& id, const Box& box);
  bool add_vibration(const proof::Vibration& id, const Box& box);
  bool carry_over(int row, const Box& box, bool symmetric);
  bool cut_cones(const Filter& filter, const Box& box, double allowed);
  bool cut_vibration(const Filter& filter, const Box& box);

  const LimitModel& model_;
  int largest_, tube_rows_ = 0;
  double slack_;
  RowDrafts drafts_;
  double least_ = 0.0;  // the cones' margin is at most this
  std::function<bool()> stop_;
  struct {
    bool window = false, ranges = false;  // ranges: delays and samples are columns
    bool clp_alone = false;
  } kind_;
  DualSimplex lp_;
  LpSolution solution_;
  RowNames names_;
};

}  // namespace accdec::exact
