#pragma once

#include <vector>

#include <accdec/task.hpp>

namespace accdec {

/// Cost of verify_by_simulation, estimated before it runs: precise enough to refuse tasks that would take too long.
struct VerificationCost {
  double samples = 0.0;  ///< of all axes of all corners together
  double bytes = 0.0;    ///< of the corner that needs most
  /// Estimate for one core of 2.6 GHz: 0.05 us per sample of an axis.
  double seconds() const { return 5e-8 * samples; }
};
/// @param delays  one per corner
VerificationCost verification_cost(const Task& task, int order, const std::vector<int>& delays);

/// @param matrices  kept at once, samples by axes each
/// @throws std::length_error in words, if simulating the corners would take more memory than there is
void require_simulation_room(const Task& task, int order, const std::vector<int>& delays, double matrices = 4.0);

}  // namespace accdec
