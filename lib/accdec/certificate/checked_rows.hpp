#pragma once

#include <limits>
#include <optional>
#include <stdexcept>
#include <vector>

#include <accdec/certificate.hpp>
#include <accdec/certificate/checked_response.hpp>
#include <accdec/certificate/checked_tap_bounds.hpp>

namespace accdec {

/// Reason for rejecting a certificate.
struct Rejected : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Delays and samples of one corner, and the times at which its path changes from one leg's strip to the other's.
struct CheckedRange {
  int d1, d2, k1, k2;
  double c1 = 0.0, c2 = 0.0;
};

/// The first sample at which an axis that reverses at a corner moves as along leg 2.
struct CheckedReversal {
  int corner, axis;
  int first = 0, last = std::numeric_limits<int>::max();
};

/// Instants of one corner, real numbers of samples, and the delay that the corner has or undercuts.
struct CheckedInstants {
  int corner = 0;
  double delay = 0.0, first = 0.0, last = 0.0;
};

/// Bounds a corner's error below at the instant `at`, by tangents of both distances. Leg 1's touches at the instant
/// `in`, leg 2's `out` samples after its start.
struct CheckedTangents {
  double in = 0.0, out = 0.0, at = 0.0;
};

/// A part of all designs: filters up to `order`, delays and samples in the ranges, responses within the cuts.
struct CheckedBox {
  std::vector<CheckedRange> corners;
  std::vector<CheckedCut> cuts;
  std::vector<CheckedReversal> reversals;  ///< from splits; others may be at any sample
  int order = -1;
  int order_least = 0, order_most = -1;     ///< from splits on the order
  std::optional<double> budget;             ///< upper bound on what the target leaves of sum_j w_j (d_j - d1_j)
  std::optional<CheckedTube> tube;          ///< only if a row needs it
  std::optional<CheckedInstants> instants;  ///< only of refutations; errors are then bounded by `tangents`
  std::optional<CheckedTangents> tangents;
  bool in_position = false;   ///< one width gives the delays of all corners
  bool window = false;        ///< filters of any order: the first and the last tap stand for many
  bool nothing_left = false;  ///< the tube is empty: no filter is in the box

  CheckedReversal reversal(int corner, int axis) const {
    for (const CheckedReversal& r : reversals)
      if (r.corner == corner && r.axis == axis) return r;
    return {corner, axis};
  }
};

/// sum_i c_i b_i + sum_k e_k B_k + sum_j (f_j (d_j - d1_j) + g_j (k_j - k1_j)) > rhs has to hold for every filter and
/// all delays and samples in the box.
struct CheckedSum {
  std::vector<Interval> taps, cumulative;  // c_i, e_k
  std::vector<Interval> delays, samples;   // f_j, g_j; empty: zero
  Interval rhs;
  long terms = 0;  ///< added so far to `taps` and `cumulative`
  CheckedSum(int order, bool window)
      : taps(static_cast<std::size_t>(order) + 1), cumulative(static_cast<std::size_t>(order) + 2), window_(window) {}
  int order() const { return static_cast<int>(taps.size()) - 1; }
  void tap(int i, const Interval& c) {
    if (i < 0 || i > order()) return;
    taps[static_cast<std::size_t>(i)] = taps[static_cast<std::size_t>(i)] + c;
    count(c);
  }
  void response(int k, const Interval& c) {
    if (k > order()) {
      rhs = rhs - c;
    } else if (k > 0) {
      cumulative[static_cast<std::size_t>(k)] = cumulative[static_cast<std::size_t>(k)] + c;
      count(c);
    }
  }
  /// The same of the command behind the smoothing, or of the motion: tap i is sum_j g_j b_{i-j}. An end of a window
  /// stands for all taps beyond it: none of them counts in tap i, or by the largest g_j there.
  void tap_behind(const std::vector<Interval>& g, int i, const Interval& c) {
    if (g.size() == 1) return tap(i, c);
    double before = 0.0, after = 0.0;
    for (const Interval& part : g) {
      if (!window_ || (i > 0 && i < order()))
        tap(i, c * part);
      else
        (i <= 0 ? before : after) = std::max(i <= 0 ? before : after, part.hi);
      --i;
    }
    tap(0, c * Interval(0.0, before));
    tap(order(), c * Interval(0.0, after));
  }
  /// In a window, of the taps that an end stands for any part counts in B_k beyond it.
  void response_behind(const std::vector<Interval>& g, int k, const Interval& c) {
    if (g.size() == 1) return response(k, c);
    for (const Interval& part : g) {
      if (window_ && (k <= 0 || k > order())) {
        response(k <= 0 ? 0 : order(), c * part);
        tap(k <= 0 ? 0 : order(), c * part * Interval(0.0, 1.0));
      } else {
        response(k, c * part);
      }
      --k;
    }
  }

 private:
  /// The product of a leg that stands still is exactly zero (interval.hpp). However small, any other is a term: all
  /// multipliers of a proof may be tiny.
  void count(const Interval& c) { terms += c.lo != 0.0 || c.hi != 0.0 ? 1 : 0; }

  bool window_;
};

/// Speeds of an axis' two legs.
struct CheckedSpeeds {
  Interval in, out;
};

/// Sets up the limits of a task as rows in interval arithmetic, from the names in a certificate.
class CheckedRows {
 public:
  /// @param task  with the limits that verification grants (granted_limits.hpp); the reference is kept
  explicit CheckedRows(const Task& task);
  double tap_max() const { return bounds_.tap_max(); }
  /// Samples by which the machine's response lengthens the motion.
  int longer() const { return response_.longer(); }
  /// Samples of the control between an in-position width and the next block.
  int latency() const;
  double watched_speed(const TaskCorner& corner) const;
  /// Cuts the delays of a box to those that one width may give to corners of these feeds.
  void order_delays(CheckedBox& box) const;
  /// The same with the box's order, after which no leg has any way left.
  void end_delays(CheckedBox& box) const;
  /// Bounds on the responses in a box; none if no filter is left.
  std::optional<CheckedTube> tube(const CheckedBox& box) const;
  /// Adds a row times its multiplier.
  /// @throws Rejected if there is no such limit, or the row does not hold in the whole box
  void add(const proof::Term& term, CheckedBox& box, CheckedSum& sum) const;

 private:
  Interval period() const { return Interval(task_.sample_period); }
  const TaskCorner& corner(int j) const;
  const Axis& axis(int a) const;
  // One function per kind of rows; rows over ranges are in checked_ranges.cpp, chords in checked_chords.cpp, widths in
  // checked_width.cpp.
  void add_row(const proof::TapDifference& row, const Interval& weight, CheckedBox& box, CheckedSum& sum) const;
  void add_row(const proof::EventForce& row, const Interval& weight, CheckedBox& box, CheckedSum& sum) const;
  void add_row(const proof::Blend& row, const Interval& weight, CheckedBox& box, CheckedSum& sum) const;
  void add_row(const proof::Error& row, const Interval& weight, CheckedBox& box, CheckedSum& sum) const;
  void add_row(const proof::RangeError& row, const Interval& weight, CheckedBox& box, CheckedSum& sum) const;
  void add_row(const proof::Contour& row, const Interval& weight, CheckedBox& box, CheckedSum& sum) const;
  void add_row(const proof::Reversal& row, const Interval& weight, CheckedBox& box, CheckedSum& sum) const;
  void add_row(const proof::Width& row, const Interval& weight, CheckedBox& box, CheckedSum& sum) const;
  void add_row(const proof::Budget& row, const Interval& weight, CheckedBox& box, CheckedSum& sum) const;
  void add_row(const proof::Vibration& row, const Interval& weight, CheckedBox& box, CheckedSum& sum) const;
  void add_row(const proof::EventPower& row, const Interval& weight, CheckedBox& box, CheckedSum& sum) const;
  void add_row(const proof::BlendPower& row, const Interval& weight, CheckedBox& box, CheckedSum& sum) const;
  void add_row(const proof::Speed& row, const Interval& weight, CheckedBox& box, CheckedSum& sum) const;
  void add_row(const proof::Response& row, const Interval& weight, CheckedBox& box, CheckedSum& sum) const;
  void add_power(const Axis& axis, bool regeneration, const CheckedSpeeds& legs, int delay, int sample, int sign,
                 double low, double high, const Interval& weight, const CheckedTube& tube, CheckedSum& sum) const;
  Interval bound_of_mode(const proof::Vibration& row, const Mode& mode, const CheckedBox& box) const;
  int single_delay(int corner, const CheckedBox& box) const;
  /// @throws Rejected if a row concerns taps at or beyond the ends of a window
  void require_inside(const proof::Row& row, const CheckedBox& box) const;
  /// False: nothing is left.
  bool need_tube(CheckedBox& box) const;

  const Task& task_;
  CheckedResponse response_;
  CheckedTapBounds bounds_;
};

/// The error of a corner at an instant of the box, in checked_instants.cpp.
/// @throws Rejected if the box has no tangents of this corner, or the direction does not grow with both distances
void add_error_at_instant(const proof::Error& row, const TaskCorner& corner, const Interval& period,
                          const Interval& weight, const CheckedBox& box, CheckedSum& sum);
/// @throws Rejected if a limit is not given
void require_limit(double bound);

}  // namespace accdec
