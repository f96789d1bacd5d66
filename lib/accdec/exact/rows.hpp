#pragma once

#include <algorithm>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <accdec/motion/filter.hpp>
#include <accdec/task/task.hpp>

namespace accdec::exact {

enum class RowKind {
  jerk,
  force_start,
  force_stop,
  blend_acceleration,
  blend_jerk,
  blend_force,
  cone,
  vibration,
  range_cone,  ///< of a corner whose delay and sample are ranges, see range_cut.hpp
  budget,      ///< what the target leaves of all delays together
  // Chords of limits outside the convex class, over the range of speeds or directions the box leaves.
  power_start,
  regeneration_stop,
  blend_power,
  blend_regeneration,
  speed,
  tube  ///< a bound of the box itself on B_sample
};

/// Where a range cut touches p or q, see range_cut.hpp.
struct Tangent {
  int at = 0;          ///< sample a
  bool after = false;  ///< slope at a + 1 instead of a
  bool high = false;   ///< the product by the upper bound on the slope, else by the lower one
};

/// One row "form(b) <= bound" by what it limits; together with a box it says all about its coefficients.
struct RowId {
  RowKind kind{};
  int sign = 1;  ///< -1: the lower side of a two-sided limit; power: the direction of travel
  int axis = -1, corner = -1, mode = -1;
  int sample = 0;
  double angle = 0.0;            ///< rad, direction of a tangent cut
  Tangent in{}, out{};           ///< range_cone
  double frequency = 0.0;        ///< Hz, vibration
  double low = 0.0, high = 0.0;  ///< ends of a chord: m/s, or rad from leg 1's direction (speed)
};
/// Whether two rows are of the same limit at the same place, whatever their chords.
inline bool same_limit(const RowId& a, const RowId& b) {
  return a.kind == b.kind && a.corner == b.corner && a.axis == b.axis && a.sample == b.sample && a.sign == b.sign;
}
using Multipliers = std::vector<std::pair<RowId, double>>;  ///< all >= 0

/// Delays d1 .. d2 and samples k1 .. k2 of one corner.
struct CornerBox {
  int d1 = 0, d2 = 0, k1 = 0, k2 = 0;
};
/// B_k >= level or B_k <= level, from a split.
struct SumBound {
  int sample = 0;
  bool upper = false;
  double level = 0.0;
};
/// Bounds low <= B_k <= high, k = 0 .. order + 1.
struct Tube {
  std::vector<double> low, high;
};
/// One corner's leg distances in samples at full speed, as weights of the taps: lower bounds wherever the caller needs
/// them.
struct Distances {
  std::vector<double> in, out;
};
struct Box {
  int order = 0;  ///< largest order in the box; shorter filters are this one with zero taps
  std::vector<CornerBox> corners;
  std::vector<SumBound> path{};  ///< splits on cumulative responses
  Tube tube{};                   ///< what they and the limits leave; empty where no row needs it
  /// At most sum_j w_j (d_j - d1_j), from the target; only where there are several corners.
  std::optional<double> budget{};
  /// One per corner, instead of those at the whole delays and samples of `corners`; empty: those. Only cuts that grow
  /// with both distances are then drawn.
  std::vector<Distances> distances{};
  std::optional<double> only_angle{};                                 ///< rad: the one cut that stands for each cone
  int order_least = 0, order_most = std::numeric_limits<int>::max();  ///< from splits on the order

  /// Weights of tap i in the least leg distances of corner j.
  double weight_in(std::size_t j, int i) const {
    return distances.empty() ? std::max(0, i - corners[j].k2) : distances[j].in[static_cast<std::size_t>(i)];
  }
  double weight_out(std::size_t j, int i) const {
    return distances.empty() ? std::max(0, corners[j].k1 - corners[j].d2 - i)
                             : distances[j].out[static_cast<std::size_t>(i)];
  }
  /// Whether more than one delay or sample is in it, or distances in place of both.
  bool ranges(std::size_t j) const { return corners[j].k1 < corners[j].k2 || corners[j].d1 < corners[j].d2; }
  bool loose(std::size_t j) const { return !distances.empty() || ranges(j); }
};

/// Sum of taps, sums (coefficients of B_k) and constant, all <= 1.
struct SparseRow {
  std::vector<std::pair<int, double>> taps, sums;
  double constant = 0.0;
};

/// Speeds of an axis' two legs, m/s.
struct Legs {
  double in = 0.0, out = 0.0;
};
Legs legs(const TaskCorner& corner, std::size_t axis);

/// The limits of a task as rows in the taps, those outside the convex class as chords over a box. Everything but the
/// cones is divided by its bound.
///
/// Power F V <= P bounds the force by the hyperbola P/V, and what lies below it over V in [l, u] has as its hull what
/// lies below its chord: F <= P (1/l + 1/u - V/(l u)). A chord from l = P/F_max on holds for all smaller speeds too, by
/// the force limit. Regeneration is the same with the force turned; the smallest speed cuts a sector of directions by
/// the chord of its circle. F and V are linear in the cumulative responses.
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
  double cos_interior(std::size_t corner) const { return task_.corners[corner].geometry().cos_interior(); }
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

  /// The limits outside the convex class: kind, axis, corner and sign of each; the sample is left open.
  const std::vector<RowId>& families() const { return families_; }
  bool convex() const { return families_.empty(); }
  /// Use of such a limit at a sample, value/bound (bound/value for the smallest speed).
  double use(const RowId& id, const Filter& filter, const Box& box) const;
  /// Chords over the box's tube that the filter breaks by more than `slack`.
  std::vector<RowId> broken_chords(const Filter& filter, const Box& box, double slack) const;
  /// The chord over the box's tube; none if the limit holds throughout or nothing can be said.
  std::optional<RowId> chord(RowId id, const Box& box) const;
  /// The chord shrunk to the filter's own speed: whatever holds it holds the limit. None where the limit is far.
  std::optional<RowId> tangent(RowId id, const Filter& filter, const Box& box) const;
  /// Adds the limits outside the convex class that the filter comes close to or breaks; returns the worst use.
  double gather_close(const Filter& filter, const Box& box, std::vector<RowId>& close) const;
  /// Whether such a limit says something of the box: limits of the blend but the smallest speed need a single delay.
  bool single_delay(const RowId& id, const Box& box) const;
  /// Last sample of a family at which its limit can matter.
  int last_sample(const RowId& id, const Box& box) const;
  /// Shrinks the box's tube by what limits on starts and stops can reach. False: nothing is left of it.
  bool shrink(Box& box) const;

 private:
  struct Speeds {
    double start = 0.0, stop = 0.0;
  };
  struct Range {
    double low, high;
  };
  Legs event_legs(const RowId& id) const;
  int event_delay(const RowId& id, const Box& box) const;
  double event_bound(const RowId& id) const;
  Range speed_range(const RowId& id, const Box& box) const;
  Range direction_range(const RowId& id, const Box& box) const;
  double force_cap(const RowId& id) const;
  bool covers(const RowId& chord, const Box& box) const;
  SparseRow chord_row(const RowId& id, const Box& box) const;
  void find_families();
  friend double refutation(const LimitModel&, const Multipliers&, const Box&, int);

  const Task& task_;
  std::vector<Speeds> speeds_;
  double tap_max_ = 1.0, jerk_max_;
  bool has_sums_ = false;
  std::vector<RowId> families_;
};

/// Lower bound of sum y (form(b) - bound) over all filters in the box, b <= tap_max, sum 1: positive refutes the box.
/// Minus infinity if a multiplier does not apply to the box.
/// @param symmetric_order  >= 0: over symmetric filters of exactly this order
double refutation(const LimitModel& model, const Multipliers& y, const Box& box, int symmetric_order = -1);

/// Orders and delays still shorter than `target` (in samples), and what it leaves of the delays: false when none is.
bool tighten(const Task& task, double target, Box& box);

}  // namespace accdec::exact
