#pragma once

#include <string_view>
#include <vector>

#include <accdec/task.hpp>

namespace accdec {

/// The objective of a design in sample periods: linear in N + 1 and in the delays.
///
/// Objective::cycle is machine time: a run from rest to rest takes its delays and, once, the filter's N + 1 samples. It
/// is `runs (N + 1) + sum_j w_j d_j`. Objective::corner counts the filter at every corner, as if each were a separate
/// run: `sum_j w_j (N + 1 + d_j)`. For one corner with weight 1 in one run both are N + 1 + d.
struct LinearCost {
  double filter = 0.0;        ///< cost of each of the N + 1 taps, > 0
  std::vector<double> delay;  ///< cost of each sample of each corner's delay, > 0: the corners' weights

  double operator()(int order, const std::vector<int>& delays) const;
  /// Whether every cost is a whole number of samples.
  bool whole() const;
  /// Cost of the given delays alone; open ones count as 0.
  double given_delays(const Task& task) const;
};

/// The objective the task names.
LinearCost cost_of(const Task& task);
/// This objective, even if the task names the other.
LinearCost cost_of(const Task& task, Objective objective);

/// s; the time a machine spends on the delays and filters, without the path length divided by the feed. `delays` has
/// one entry per corner.
double cycle_time(const Task& task, int order, const std::vector<int>& delays);
/// s; each corner by itself, weighted: Objective::corner.
double corner_time(const Task& task, int order, const std::vector<int>& delays);
/// s; the one of these two that the task names.
double objective_time(const Task& task, int order, const std::vector<int>& delays);

/// "cycle" and "corner".
std::string_view to_string(Objective objective);

}  // namespace accdec
