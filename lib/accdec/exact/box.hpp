#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include <accdec/exact/servo_ramps.hpp>
#include <accdec/task.hpp>

namespace accdec::exact {

inline constexpr double infinity = std::numeric_limits<double>::infinity();

/// Delays d1 .. d2 and samples k1 .. k2 of one corner. The path changes from leg 1's strip of the contour tolerance to
/// leg 2's at a time in c1 .. c2, in samples. As the path is the polyline, that is not a whole number.
struct CornerBox {
  int d1 = 0, d2 = 0, k1 = 0, k2 = 0;
  double c1 = 0.0, c2 = 0.0;
};
/// B_k >= level or B_k <= level, from a split; of the motion.
struct SumBound {
  int sample = 0;
  bool upper = false;
  double level = 0.0;
};
/// The first sample at which an axis that reverses at a corner moves as along leg 2.
struct ReversalRange {
  int corner = 0, axis = 0;
  int first = 0, last = std::numeric_limits<int>::max();
};
/// Bounds low <= B_k <= high of the motion, k = 0 .. its order + 1.
struct Tube {
  std::vector<double> low, high;
};
/// One corner's leg distances in samples at full speed, as weights of the taps: lower bounds wherever the caller needs
/// them.
struct Distances {
  std::vector<double> in, out;
};
/// A part of all designs.
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
  bool window = false;                ///< filters of any order by their taps 0 .. order, see window.hpp
  const ServoRamps* servo = nullptr;  ///< of the task's response; null: there is none

  std::vector<ReversalRange> reversals{};  ///< from splits; others may be at any sample

  ReversalRange reversal(int j, int axis) const {
    for (const ReversalRange& range : reversals)
      if (range.corner == j && range.axis == axis) return range;
    return {j, axis};
  }
  const CornerBox& corner(int j) const { return corners[static_cast<std::size_t>(j)]; }
  /// The least k - d of corner j. The last column of a window stands for all taps after it, too, and they are not in q.
  int first_out(std::size_t j) const {
    const int m = corners[j].k1 - corners[j].d2;
    return window ? std::min(m, order) : m;
  }
  /// Weights of tap i in the least leg distances of corner j.
  double weight_in(std::size_t j, int i) const {
    if (!distances.empty()) return distances[j].in[static_cast<std::size_t>(i)];
    if (servo == nullptr) return std::max(0, i - corners[j].k2);
    // The first column of a window stands for all taps before it, too, and the last of them is all but gone.
    return window && i == 0 ? 0.0 : servo->in(i - corners[j].k2);
  }
  double weight_out(std::size_t j, int i) const {
    if (!distances.empty()) return distances[j].out[static_cast<std::size_t>(i)];
    return servo == nullptr ? std::max(0, first_out(j) - i) : servo->out(first_out(j) - i);
  }
  /// Weights of tap i in the leg distances of corner j at its contour times: leg 1's at the last, leg 2's at the first.
  double contour_in(std::size_t j, int i) const {
    const double k = std::floor(corners[j].c2), part = corners[j].c2 - k;
    const int x = i - static_cast<int>(k);
    return (1.0 - part) * ramp_in(x) + part * ramp_in(x - 1);
  }
  double contour_out(std::size_t j, int i) const {
    const double time = corners[j].c1 - corners[j].d2, m = std::floor(time), part = time - m;
    const int y = static_cast<int>(m) - i;
    return (1.0 - part) * ramp_out(y) + part * ramp_out(y + 1);
  }
  double ramp_in(int x) const { return servo == nullptr ? std::max(0, x) : servo->in(x); }
  double ramp_out(int y) const { return servo == nullptr ? std::max(0, y) : servo->out(y); }
  /// Whether contour tolerances are bounded: not of windows, nor of distances in place of samples.
  bool contour_rows() const { return !window && distances.empty(); }
  /// Whether more than one delay or sample is in it, or distances in place of both.
  bool ranges(std::size_t j) const { return corners[j].k1 < corners[j].k2 || corners[j].d1 < corners[j].d2; }
  /// Whether any tap is far enough out to be in a corner's least distances.
  bool bounds_error(std::size_t j) const {
    return !distances.empty() || order + longer() > corners[j].k2 || first_out(j) > 0;
  }
  /// Samples by which the task's response lengthens the motion.
  int longer() const { return servo == nullptr ? 0 : servo->longer(); }
  /// The last sample of a blend that still changes anything, for the longest filter and delay.
  int last_sample(std::size_t j) const { return order + corners[j].d2 + 1 + longer(); }
  /// Cuts samples and contour times to those that still change anything.
  void end_samples() {
    for (std::size_t j = 0; j < corners.size(); ++j) {
      corners[j].k2 = std::min(corners[j].k2, last_sample(j));
      corners[j].c2 = std::min(corners[j].c2, static_cast<double>(last_sample(j)));
    }
  }
  bool loose(std::size_t j) const { return window || !distances.empty() || ranges(j); }
};

/// Orders and delays still shorter than `target` (in samples), and what it leaves of the delays: false when none is.
bool tighten(const Task& task, double target, Box& box);

}  // namespace accdec::exact
