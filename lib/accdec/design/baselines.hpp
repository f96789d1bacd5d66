#pragma once

#include <atomic>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include <accdec/motion/filter_spec.hpp>
#include <accdec/task/result.hpp>
#include <accdec/task/task.hpp>

namespace accdec {

/// A family of filters that controllers have, to hold a design against: one shape, with or without pairs of impulses
/// behind it.
struct Baseline {
  std::string_view name;   ///< "boxcar", "averages-zv", ...: columns and options
  std::string_view title;  ///< "three averages, ZV"
  Shape shape;
  int pairs;  ///< see FilterSpec
};

/// Every family, in the order of tables and figures.
std::span<const Baseline> baselines();
/// Null for a name that is none.
const Baseline* find_baseline(std::string_view name);

struct BaselineResult {
  std::optional<FilterSpec>
      spec;             ///< the filter in the words of a task file; none when no order within the task's bounds will do
  DesignResult result;  ///< feasible (the family's best, verified by simulation), infeasible or failed; its task has
                        ///< the filter in place
};

/// Whether no corner's legs overlap: the delays are those of a machine that stops.
bool stops_exactly(const DesignResult& result);

/// The best that one family can do under a task's limits: the least cost (objective.hpp) over every order within the
/// task's bounds and every value of the family's parameters, each corner with the smallest delay at which its error
/// bound and all limits hold. Whole parameters (ramp, lengths, delay of a pair) are enumerated; a real one (cut-off,
/// alpha, ratio) is searched by branch and bound over its range, down to 1e-8 of it. Orders, delays and responses that
/// cannot beat the best are left out by lower bounds, nothing else is. Of equal costs the lowest order counts. Pairs of
/// impulses are there to cancel a vibration: families with them need a task with modes. Where two averages hold the
/// limits, the search ends at `baseline_hopeless` times their cost. The task's own filter, if any, is ignored; given
/// delays stay.
/// @param seconds  of wall time: what is best by then is the answer, and its message says that the search was not ended
BaselineResult best_baseline(const Task& task, const Baseline& baseline, double seconds = unlimited);
/// All of them, in their order.
/// @param seconds  of wall time: a family that is not searched to the end by then is without a filter (status failed)
/// @param cancel   ends the search as the time does; null: nothing does
std::vector<BaselineResult> best_baselines(const Task& task, double seconds = unlimited,
                                           const std::atomic<bool>* cancel = nullptr);

/// No family this many times slower than two averages is of interest to anybody; some (exponentials under a jerk limit)
/// would be searched for minutes.
inline constexpr double baseline_hopeless = 3.0;

}  // namespace accdec
