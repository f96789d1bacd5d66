#pragma once

#include <optional>
#include <vector>

#include <accdec/certificate.hpp>
#include <accdec/exact/box.hpp>
#include <accdec/filter.hpp>
#include <accdec/task.hpp>

// Internal to the exact method: delays of all corners by one in-position width w. They are d = L + e with the control's
// latency L, where e = min{e >= 0: v1 T p(e) <= w}. They exist together if some w has v_i p(e_i) <= w/T for all i, and
// w/T < v_j p(e_j - 1) for all j with e_j > 0. This is linear in the taps.

namespace accdec::exact {

/// Whether the task's control delays every corner by one width and has no other delays.
bool by_one_width(const Task& task);
/// Whether every width gives two corners the same delay.
bool same_by_width(const Task& task, int a, int b);
/// The control's latency, samples; 0 for other tasks. Delays may be longer than the motion by it.
int width_latency(const Task& task);
/// Faster corners wait at least as long: p(e_i) < p(e_j - 1) where v_i >= v_j. Nothing is left of any leg after the
/// filter's order. Cuts the delays of a box of known order; false: nothing is left of it. True for other tasks.
bool cut_by_width(const Task& task, Box& box);
/// The same without the order.
bool order_by_width(const Task& task, std::vector<CornerBox>& corners);

/// The row of a pair of corners in a box, in samples of the faster corner's feed.
struct WidthRow {
  double within = 0.0, before = 0.0;         ///< feeds over the faster one
  int sample_within = 0, sample_before = 0;  ///< e_i at most, e_j - 1 at least
  bool actual = false;                       ///< weights of designed taps; else of the command's

  double weight(const Box& box, int tap) const;
};
/// None: corner `before` may have no delay by the width in this box, or the row says nothing there.
std::optional<WidthRow> width_row(const Task& task, const proof::Width& id, const Box& box);

/// Samples by which verification may see the row broken, and by which designs keep it.
inline constexpr double width_granted = 1e-9, width_margin = 1e-6;

/// The pair of corners whose row a filter breaks most, if it does not keep the margin. For tasks of one width.
std::optional<proof::Width> broken_width(const Task& task, const Filter& designed, const Filter& command,
                                         const Box& box);

}  // namespace accdec::exact
