#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <utility>
#include <vector>

#include <accdec/certificate.hpp>
#include <accdec/exact/box.hpp>
#include <accdec/exact/smoothing.hpp>
#include <accdec/filter.hpp>
#include <accdec/machine/limits.hpp>

namespace accdec::exact {

/// Indices with their coefficients. A row has few of them, and thousands of rows are made, so they are kept in place.
class FewTerms {
 public:
  using Term = std::pair<int, double>;
  static constexpr std::size_t most = std::max(4, 2 * (most_differences + 1));  ///< of two legs each

  void emplace_back(int number, double coefficient) { terms_.at(size_++) = {number, coefficient}; }
  bool empty() const { return size_ == 0; }
  const Term* begin() const { return terms_.data(); }
  const Term* end() const { return terms_.data() + size_; }

 private:
  std::array<Term, most> terms_;
  std::size_t size_ = 0;
};

/// Sum of taps, sums (coefficients of B_k) and constant, all <= 1.
struct SparseRow {
  FewTerms taps, sums;
  double constant = 0.0;
  bool of_motion = false;  ///< taps and sums are of the motion, not of the command
  /// No tap of the box's filters is in the row: it lies past the end of a shorter filter.
  bool no_terms() const { return taps.empty() && sums.empty(); }
};

/// Speeds of an axis' two legs, m/s.
struct Legs {
  double in = 0.0, out = 0.0;
};
Legs legs(const TaskCorner& corner, std::size_t axis);
/// How much dry friction takes from a force to one side, N, while two legs meet. An axis that keeps its direction has
/// friction against it. One that reverses pushes to leg 2's side all the time. Before it moves there, friction helps.
double friction_help(const Axis& axis, const Legs& v, int sign, bool reversed);

/// Fastest leg of one axis at the starts and at the stops of all corners, m/s.
struct EventSpeeds {
  double start = 0.0, stop = 0.0;
};
std::vector<EventSpeeds> event_speeds(const Task& task);

/// A limit on differences of the acceleration at start and stop of the fastest leg, as a limit on differences of the
/// taps. Behind smoothing the acceleration itself is one, as it is not of the designed taps.
struct RampLimit {
  LimitKind kind;
  int differences;  ///< >= 0
  double max;       ///< on |sum_j w_j b_{i-j}| with the weights of that difference
};

/// The limits of a task that are linear in the taps for a given delay, as rows divided by their bound. Taps and sums of
/// these rows are of the command behind the control's smoothing. Those of forces are of the motion behind the servo.
class ConvexRows {
 public:
  /// Keeps the reference.
  explicit ConvexRows(const Task& task);

  const Smoothing& smoothing() const { return smoothing_; }
  const Smoothing& motion() const { return motion_; }
  /// Whether the motion is another than the command.
  bool servo() const { return motion_.order() > smoothing_.order(); }
  double tap_max() const { return tap_max_; }                  ///< of a designed tap, from accelerations, <= 1
  double command_tap_max() const { return command_tap_max_; }  ///< of one behind the control's smoothing
  const std::vector<RampLimit>& ramps() const { return ramps_; }
  /// The bound of one of these limits; infinite if there is none.
  double ramp_max(LimitKind kind) const;

  /// Force rows of start and stop for orders of the designed filter up to `order`. None behind a servo: there each row
  /// has many taps, and few rows bind.
  std::vector<proof::Row> base_force_rows(int order) const;
  /// Coefficients of a row; terms beyond the box's order are dropped.
  SparseRow row(const proof::TapDifference& id, const Box& box) const;
  SparseRow row(const proof::EventForce& id, const Box& box) const;
  SparseRow row(const proof::Blend& id, const Box& box) const;
  SparseRow row(const proof::Reversal& id, const Box& box) const;
  /// Adds the coefficients of the designed taps in a row of the motion, times a factor > 0. The ends of a window get at
  /// most the coefficient of any tap that they stand for.
  void add_motion(const SparseRow& row, double factor, bool window, std::span<double> designed) const;
  /// The same of any row; one of the command is left as one.
  void add(const SparseRow& row, double factor, bool window, WeightedTaps& sum) const;
  /// Rows of blends and reversals that a filter breaks by more than `slack`, and rows of starts and stops along
  /// force-speed curves and behind a servo.
  /// @param peaks  behind a servo, neighbouring forces are almost equal: only those that neither neighbour exceeds
  std::vector<proof::Row> broken_blend_rows(const Filter& filter, const Box& box, double slack,
                                            bool peaks = false) const;
  /// Bound of a vibration row. For a mode of an axis it follows from the speeds of starts and stops, or of the row's
  /// blend. Infinite: no bound, or the box has several delays of that corner, or its delay is the longest and stands
  /// for all longer ones, which have another phase.
  double vibration_bound(const proof::Vibration& id, const Box& box) const;
  /// The same without a blend: of the ratio, or of starts and stops.
  double vibration_bound(const proof::Vibration& id) const;
  /// Whether the blend of a corner, at the box's delay, leaves a mode of an axis with more than its bound.
  bool breaks_residual(const Filter& filter, const Box& box, std::size_t corner, double slack) const;
  /// Adds y times the coefficients of a vibration row. @param taps  all of a command, as damping counts from the last
  void add_vibration(const proof::Vibration& id, double y, std::span<double> taps) const;

 private:
  /// A force with its line of the axis' force-speed curve, or its largest force, as a force with other friction.
  struct ForceRow {
    double bound, drag;  ///< N; N s/m
  };
  ForceRow force_row(int axis, int line, double sign, double direction) const;
  /// Forces of a filter behind a servo, in a window: only those that its rows are broken by.
  void leave_broken_in_window(const Filter& filter, const Box& box, double slack, std::vector<proof::Row>& rows) const;
  bool limits_forces() const {
    return std::ranges::any_of(task_.machine.axes, [](const Axis& axis) {
      return axis.force_max < unlimited || axis.force_speed_max < unlimited;
    });
  }
  /// -1 stands for the largest force.
  int first_line(std::size_t axis) const { return task_.machine.axes[axis].force_max < unlimited ? -1 : 0; }
  class Broken;
  void add_broken_event_forces(const Filter& motion, std::size_t axis, Broken& out) const;
  void add_broken_reversals(const Filter& motion, const Box& box, Broken& out) const;
  void add_broken_forces(const Filter& motion, const Box& box, std::size_t corner, std::size_t axis, Broken& out) const;
  void add_broken_differences(const Filter& command, const Box& box, std::size_t corner, std::size_t axis,
                              Broken& out) const;

  const Task& task_;
  Smoothing smoothing_, motion_;
  std::vector<std::vector<ForceLine>> lines_;  ///< of each axis
  std::vector<EventSpeeds> speeds_;
  double tap_max_ = 1.0, command_tap_max_ = 1.0;
  std::vector<RampLimit> ramps_;
  std::array<double, most_differences + 1> period_to_the_;  ///< s^n, by n
};

}  // namespace accdec::exact
