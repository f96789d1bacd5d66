#pragma once

#include <functional>
#include <optional>
#include <vector>

#include <accdec/task.hpp>

namespace accdec {

/// The delay of a control's exact stop, samples: it waits until the last command has left all taps. Zero taps count, as
/// a control does not know its taps.
/// @param filter  of the command, behind the control's smoothing
inline int exact_stop_delay(const Filter& filter) {
  return filter.order();
}

/// Samples that a limit may ask for behind that. No word of a control makes its exact stop wait longer.
inline constexpr int exact_stop_more = 1;

/// Delays of one filter at every corner, of the kinds that a controller has.
struct KindDelays {
  std::vector<int> delays;             ///< samples
  std::vector<DelayKind> kinds;        ///< of each corner; empty if the task names none
  std::optional<WidthInterval> width;  ///< where a corner is in-position
  std::vector<double> parts{};         ///< of the feed, at which each corner is passed; empty: all at feed
  double lost = 0.0;                   ///< samples of the objective that parts of the feed cost
};

/// The cheapest delays of the kinds that the task's settings name, at which the error bounds and all limits hold with
/// this filter; given delays are kept. Empty if there are none, or if the task's objective is not below `samples`
/// sample periods. Without any kind, those of `delays_by_formula`, whose slack this has too. One in-position width
/// holds for all corners that are in-position. Every width that gives other delays is tried: O(corners N) of them, and
/// each delay that is met once costs O(axes (N + d)).
/// @param stop  polled; true ends the search with no answer
std::optional<KindDelays> delays_of_kinds(const Filter& filter, const Task& task, double samples,
                                          const std::function<bool()>& stop = {});

/// The in-position widths at which every corner with this mask has its delay; empty if there are none. Widths must
/// differ by more than a part in 10^9 to be told apart.
/// @param in_position  one per corner: whether it is in-position
std::optional<WidthInterval> width_of(const Filter& filter, const Task& task, const std::vector<int>& delays,
                                      const std::vector<bool>& in_position);

}  // namespace accdec
