#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

#include <accdec/files/memory.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/task/verification_cost.hpp>

namespace accdec {

VerificationCost verification_cost(const Task& task, int order, const std::vector<int>& delays) {
  VerificationCost cost;
  const double axes = static_cast<double>(task.machine.axes.size());
  const Response response(task.machine, task.sample_period);
  order += response.order();
  const double motions = response.ideal() ? 1.0 : 2.0;  // the command's and the servo's
  for (const int delay : delays) {
    // Rest, leg, delay, leg, rest; see simulate_corner.
    const double samples = axes * (4.0 * (order + 4.0) + std::max(delay, 0));
    cost.samples += samples;
    // Position, velocity, acceleration and jerk.
    cost.bytes = std::max(cost.bytes, 4.0 * sizeof(double) * samples * motions);
  }
  return cost;
}

void require_simulation_room(const Task& task, int order, const std::vector<int>& delays, double matrices) {
  // The verification keeps four: position, velocity, acceleration and jerk.
  const double bytes = matrices / 4.0 * verification_cost(task, order, delays).bytes;
  // For small ones the system need not be asked.
  if (bytes < 1e9) return;
  const double there = available_memory();
  if (bytes <= 0.8 * there) return;
  throw std::length_error(
      fmt::format("simulating a corner of order {} with its delay would take {:.3g} GB of memory, {:.3g} GB are there",
                  order, 1e-9 * bytes, 1e-9 * there));
}

}  // namespace accdec
