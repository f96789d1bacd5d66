#pragma once

#include <string_view>
#include <vector>

#include <accdec/task/task.hpp>

namespace accdec {

/// What a design minimises, in sample periods: linear in N + 1 and in the delays.
///
/// Objective::cycle is machine time: a run from rest to rest pays its delays and, once, the filter's N + 1 samples;
/// `runs (N + 1) + sum_j w_j d_j`. Objective::corner counts the filter at every corner, as if each were a run of its
/// own: `sum_j w_j (N + 1 + d_j)`. Of one corner with weight 1 in one run both are N + 1 + d.
struct LinearCost {
  double filter = 0.0;        ///< of each of the N + 1 taps, > 0
  std::vector<double> delay;  ///< of each sample of each corner's delay, > 0: the corners' weights

  double operator()(int order, const std::vector<int>& delays) const;
  /// Whether every cost is a whole number of samples.
  bool whole() const;
  /// Of given delays alone, the open ones 0.
  double given_delays(const Task& task) const;
};

/// The objective the task names.
LinearCost cost_of(const Task& task);
/// One objective, whichever the task names.
LinearCost cost_of(const Task& task, Objective objective);

/// s; the time a machine spends on the delays and filters, way over feed not counted. `delays` has one entry per
/// corner.
double cycle_time(const Task& task, int order, const std::vector<int>& delays);
/// s; each corner by itself, weighted: Objective::corner.
double corner_time(const Task& task, int order, const std::vector<int>& delays);
/// s; of these two the one the task names.
double objective_time(const Task& task, int order, const std::vector<int>& delays);

/// "cycle" and "corner".
std::string_view to_string(Objective objective);

}  // namespace accdec
