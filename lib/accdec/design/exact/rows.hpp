#pragma once

#include <accdec/design/task.hpp>
#include <accdec/motion/filter.hpp>
#include <span>
#include <utility>
#include <vector>

namespace accdec::exact {

enum class RowKind { jerk, force_start, force_stop, blend_acceleration, blend_jerk, blend_force, cone, vibration };

/// One row "form(b) <= bound" by what it limits; together with a box it says all about its coefficients.
struct RowId {
  RowKind kind{};
  int sign = 1;  ///< -1: the lower side of a two-sided limit
  int axis = -1, corner = -1, mode = -1;
  int sample = 0;
  double angle = 0.0;      ///< rad, direction of a tangent cut
  double frequency = 0.0;  ///< Hz, vibration
};
using Multipliers = std::vector<std::pair<RowId, double>>;  ///< all >= 0

/// Delays d1 .. d2 and samples k1 .. k2 of one corner.
struct CornerBox {
  int d1 = 0, d2 = 0, k1 = 0, k2 = 0;
};
struct Box {
  int order = 0;  ///< largest order in the box; shorter filters are this one with zero taps
  std::vector<CornerBox> corners;
};

/// Sum of taps, sums (coefficients of B_k) and constant, all <= 1.
struct SparseRow {
  std::vector<std::pair<int, double>> taps, sums;
  double constant = 0.0;
};

/// The convex limits of a task as rows in the taps. Everything but the cones is divided by its bound.
class LimitModel {
 public:
  explicit LimitModel(const Task& task);

  const Task& task() const { return task_; }
  double tap_max() const { return tap_max_; }    ///< from accelerations, <= 1
  double jerk_max() const { return jerk_max_; }  ///< on |b_i - b_{i-1}|; infinite if none
  bool has_sums() const { return has_sums_; }    ///< force with friction needs cumulative responses
  std::size_t corners() const { return task_.corners.size(); }
  bool cone(std::size_t corner) const { return task_.corners[corner].error_max.has_value(); }
  double error_bound(std::size_t corner) const;               ///< in samples of the faster leg
  double weight_in(std::size_t corner, double angle) const;   ///< of p in a cut, scaled as error_bound
  double weight_out(std::size_t corner, double angle) const;  ///< of q
  double cos_interior(std::size_t corner) const { return task_.corners[corner].geometry.cos_interior(); }
  double theta(std::size_t corner) const;
  double scale_in(std::size_t corner) const;
  double scale_out(std::size_t corner) const;

  /// Force rows of start and stop for orders up to `order`.
  std::vector<RowId> base_force_rows(int order) const;
  /// Coefficients of a jerk, force or blend row; terms beyond the order are dropped.
  SparseRow row(const RowId& id, const Box& box) const;
  /// Blend rows that `taps` breaks by more than `slack`.
  std::vector<RowId> broken_blend_rows(const Filter& filter, const Box& box, double slack) const;
  /// Dense coefficient of tap i in a vibration row.
  double vibration_coefficient(const RowId& id, int i) const;

 private:
  struct Speeds {
    double start = 0.0, stop = 0.0;
  };
  const Task& task_;
  std::vector<Speeds> speeds_;
  double tap_max_ = 1.0, jerk_max_;
  bool has_sums_ = false;
};

/// Lower bound of sum y (form(b) - bound) over all filters in the box, b <= tap_max, sum 1: positive refutes the box.
/// Minus infinity if a multiplier does not apply to the box.
/// @param symmetric_order  >= 0: over symmetric filters of exactly this order
double refutation(const LimitModel& model, const Multipliers& y, const Box& box, int symmetric_order = -1);

/// Orders and delays still shorter than `target` (in samples): false when none is.
bool tighten(const Task& task, double target, Box& box);

}  // namespace accdec::exact
