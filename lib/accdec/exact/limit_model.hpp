#pragma once

#include <memory>

#include <accdec/exact/chords.hpp>
#include <accdec/exact/rows.hpp>
#include <accdec/exact/tube.hpp>

namespace accdec::exact {

using Multipliers = proof::Multipliers;

/// The limits of a task as rows in the taps. Linear limits are rows; limits outside the convex class are chords over a
/// box; corner errors are cones, drawn as cuts. Designs must hold the limits as written. Refutations and the tube use
/// the limits that verification grants (verify.hpp). Keeps the reference to the task.
class LimitModel {
  struct Granted;
  std::unique_ptr<Granted> granted_;  ///< null: these are the granted limits

 public:
  explicit LimitModel(const Task& task);
  ~LimitModel();

  const ConvexRows rows;
  const Chords chords;
  const TubeLimits tube;
  const ServoRamps ramps;

  /// The task's response as boxes need it; null if there is none.
  const ServoRamps* servo() const { return ramps.ideal() ? nullptr : &ramps; }

  const Task& task() const { return task_; }
  /// The model of the limits that a refutation has to hold for.
  const LimitModel& granted() const;
  /// Call after tolerances of the task have changed; designs follow them at once.
  void follow_tolerances();
  std::size_t corners() const { return task_.corners.size(); }
  bool convex() const { return chords.families().empty(); }

  bool cone(std::size_t corner) const { return task_.corners[corner].error_max.has_value(); }
  double error_bound(std::size_t corner) const;  ///< in samples of the faster leg
  /// Whether a corner has a contour tolerance that can bind.
  bool contour(std::size_t corner) const;
  double contour_bound(std::size_t corner) const;             ///< of both legs' distances, in samples of the faster leg
  double weight_in(std::size_t corner, double angle) const;   ///< of p in a cut, scaled as error_bound
  double weight_out(std::size_t corner, double angle) const;  ///< of q
  double cos_interior(std::size_t corner) const { return task_.corners[corner].geometry().cos_interior(); }
  double theta(std::size_t corner) const;
  double scale_in(std::size_t corner) const;
  double scale_out(std::size_t corner) const;

  /// Coefficients of a row in taps and sums. @throws std::logic_error of errors, budgets and vibration, which are dense
  SparseRow row(const proof::Row& id, const Box& box) const;
  bool shrink(Box& box) const { return tube.shrink(box); }

 private:
  LimitModel(const Task& granted, std::nullptr_t);

  const Task& task_;
};

/// Lower bound of sum y (form(b) - bound) over all filters in the box with b <= tap_max and sum 1. Bounds and tap_max
/// are those that verification grants. A positive result refutes the box. Minus infinity if a multiplier does not apply
/// to the box. In refutation.cpp.
/// @param symmetric_order  >= 0: over symmetric filters of exactly this order
double refutation(const LimitModel& model, const Multipliers& y, const Box& box, int symmetric_order = -1);

}  // namespace accdec::exact
