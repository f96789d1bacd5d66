#pragma once

#include <vector>

#include <accdec/task/task.hpp>

namespace accdec {

/// What verify_by_simulation costs, before it costs anything: near enough to refuse what nobody would wait for.
struct VerificationCost {
  double samples = 0.0;  ///< of all axes of all corners together
  double bytes = 0.0;    ///< of the corner that takes most
  /// About, on one core of 2.6 GHz: 0.05 us a sample of an axis.
  double seconds() const { return 5e-8 * samples; }
};
/// @param delays  one per corner
VerificationCost verification_cost(const Task& task, int order, const std::vector<int>& delays);

/// @param matrices  kept at once, samples by axes each
/// @throws std::length_error in words, if simulating the corners would take more memory than there is
void require_simulation_room(const Task& task, int order, const std::vector<int>& delays, double matrices = 4.0);

}  // namespace accdec
