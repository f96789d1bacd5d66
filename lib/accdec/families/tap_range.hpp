#pragma once

#include <span>
#include <vector>

#include <accdec/task.hpp>
#include <accdec/task/objective.hpp>

namespace accdec {

/// All filters of one order whose taps lie between bounds. They describe a family whose parameter is in an interval.
struct TapRange {
  std::vector<double> low, high;                        ///< b_i, i = 0 .. N
  std::vector<double> cumulative_low, cumulative_high;  ///< B_k, k = 0 .. N + 1
  std::vector<double> stop_low, stop_high;              ///< p(k) = sum_i b_i max(i - k, 0), k = 0 .. N
  std::vector<double> start_low, start_high;            ///< q(m) = sum_i b_i max(m - i, 0), m = 0 .. N

  int order() const { return static_cast<int>(low.size()) - 1; }
};

/// The range of all filters between two filters tap by tap, before the taps are divided by their sum, followed by pairs
/// of impulses (with_pairs).
TapRange tap_range(std::span<const double> one, std::span<const double> other, int pairs, int pair_delay);

/// A frequency of a vibration band.
struct Tone {
  double phase;         ///< rad per sample
  double residual_max;  ///< bound on the response there
};

/// A lower bound on the cost, in samples, of every filter of a range with the delays it needs. It is infinite if every
/// filter breaks a limit. Every limit is checked with its smallest possible value, vibration only at the given tones.
/// So the bound becomes exact as the range gets narrow. O(N (axes + log N)) per corner, and O(axes N) for each delay
/// that a limit of the blend refuses.
/// @param least  delays below which no filter within the task's limits works, one per corner
/// @param best  costs from here on do not matter: the search may end there
double lower_cost(const TapRange& range, const Task& task, const LinearCost& cost, const std::vector<Tone>& tones,
                  const std::vector<int>& least, double best);

}  // namespace accdec
