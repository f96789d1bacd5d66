#pragma once

#include <accdec/task.hpp>

namespace accdec {

/// A lower bound on the order of any filter that starts every leg of the task from rest within the acceleration, force
/// and power limits. If only speed-dependent bounds limit a start, it is fastest when every sample saturates the
/// tightest of them.
/// @return at least 0; `limit` + 1 if not even `limit` is enough.
int order_lower_bound(const Task& task, int limit);

/// That fastest start as taps (largest cumulative response at every sample), of the order `order_lower_bound` returns.
/// The last tap takes what is left. Empty if the bound exceeds `limit`.
std::vector<double> saturating_start(const Task& task, int limit);

}  // namespace accdec
