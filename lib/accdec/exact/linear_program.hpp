#pragma once

#include <algorithm>
#include <functional>
#include <variant>
#include <vector>

#include <accdec/exact/clp_fallback.hpp>
#include <accdec/exact/dual_simplex.hpp>
#include <accdec/exact/limit_model.hpp>
#include <accdec/exact/relaxation.hpp>

// Internal to the exact method: the rows of its linear program.

namespace accdec::exact {

/// The linear program meets limits within this tolerance, well below the verifier's 1e-9. So a limit used to its last
/// bit does not fall between a solution that verifies and a refutation.
inline constexpr double slack = 3e-10;
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
  void use_clp_alone(bool alone) { clp_alone_ = alone; }
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
  bool has_ranges() const { return ranges_; }
  /// d - d1 and k - k1 of corner j in the current solution, in the same units.
  double delay(std::size_t j) const { return solution_.point[static_cast<std::size_t>(delay_column(j))]; }
  double sample(std::size_t j) const { return solution_.point[static_cast<std::size_t>(delay_column(j)) + 1]; }
  /// Duals of the current solution as multipliers of the rows' limits. Equations have no part in a proof.
  Multipliers multipliers() const;
  long pivots() const { return lp_.pivots(); }

 private:
  /// A row on its way into the linear program.
  struct Draft {
    std::vector<int> columns;
    std::vector<double> values;
    double low = 0.0, high = 0.0;
    void clear() { columns.clear(), values.clear(); }
    void add(int column, double value) { columns.push_back(column), values.push_back(value); }
  };
  int excess() const { return largest_ + 1; }
  int delay_column(std::size_t j) const { return largest_ + 2 + 2 * static_cast<int>(j); }
  bool shared(std::size_t j, const Box& box) const {
    return box.budget && box.ranges(j) && box.servo == nullptr;  // tangents behind a response are not known
  }
  double broken() const { return slack_ + slack; }  // a limit counts as broken if it exceeds its row by more than this
  /// Symmetry of filters of one order, or the sum of taps (order 0). It is no limit, so it is no part of a proof.
  struct Equation {
    int order = 0;
  };
  /// Meaning of a row of the linear program.
  using Id = std::variant<Equation, proof::Row>;
  /// The limit of a row if it is of this kind; else null.
  template <class Limit>
  static const Limit* limit_of(const Id& id) {
    const auto* row = std::get_if<proof::Row>(&id);
    return row != nullptr ? std::get_if<Limit>(row) : nullptr;
  }
  double vibration_scale(const proof::Vibration& id) const;
  double tap_bound(int column) const;
  void add(Id id);  // the draft
  void add_tangents(const std::vector<Chord>& close, const Filter& at, const Box& box, double least_use, bool soft);
  void add_base_rows();
  void draft_limit(const SparseRow& row, double scale, bool both, bool soft = false);
  void draft_cone(const proof::Error& id, const Box& box);
  void draft_vibration(const proof::Vibration& id, const Box& box);
  void add_cone(std::size_t j, double angle, const Box& box);
  void add_symmetry(const Box& box);
  void draft_budget(const Box& box);
  void draft_range_cone(const proof::RangeError& id, const Box& box);
  void prepare_ranges(const Box& box);
  void cut_ranges(std::size_t j, const Filter& filter, const Box& box, double allowed, bool& added);
  /// Whether the cuts have a row of this kind that is the same according to `same`.
  template <class Limit, class Same>
  bool known(const Same& same) const {
    return std::any_of(ids_.begin() + base_rows_, ids_.end(), [&](const Id& id) {
      const Limit* old = limit_of<Limit>(id);
      return old != nullptr && same(*old);
    });
  }
  bool add_limit(const proof::Row& id, const Box& box);
  bool add_vibration(const proof::Vibration& id, const Box& box);
  bool carry_over(int row, const Box& box, bool symmetric);
  // Draft the row of one limit in a new box; false: it says nothing there.
  bool redraft(const proof::Error& id, const Box& box);
  bool redraft(const proof::RangeError& id, const Box& box);
  bool redraft(const proof::Blend& id, const Box& box);
  bool redraft(Chord& chord, const Box& box);
  bool cut_cones(const Filter& filter, const Box& box, double allowed);
  bool cut_vibration(const Filter& filter, const Box& box);

  const LimitModel& model_;
  int largest_, base_rows_ = 0, tube_rows_ = 0;
  double slack_;
  double least_ = 0.0;  // the cones' margin is at most this
  std::function<bool()> stop_;
  bool window_ = false, clp_alone_ = false;
  bool ranges_ = false;  // delays and samples are columns
  DualSimplex lp_;
  LpSolution solution_;
  std::vector<Id> ids_;
  Draft draft_;
  std::vector<double> on_tap_;
};

}  // namespace accdec::exact
