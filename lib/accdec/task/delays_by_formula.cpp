#include <algorithm>
#include <cmath>

#include <accdec/corner.hpp>
#include <accdec/machine/limits.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/task/blend_check.hpp>
#include <accdec/task/delays_by_formula.hpp>
#include <accdec/task/objective.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

/// The starts and stops of all corners.
bool ramps_hold(const BlendLimits& limits, const Task& task) {
  return std::ranges::all_of(task.corners, [&](const TaskCorner& corner) {
    return ramps_hold(limits, LegVelocities(corner.geometry()), formula_slack);
  });
}

}  // namespace

bool holds_without_blends(const BlendLimits& limits, const Filter& filter, const Task& task,
                          const std::function<bool()>& stop) {
  if (!ramps_hold(limits, task)) return false;
  const FilterBehind behind(filter, task.machine, task.sample_period);
  const Filter& command = behind.command();
  // Most filters that ring too much do so at an end or the middle of a band. Only for the others the whole band must be
  // searched.
  for (const Mode& mode : task.machine.modes) {
    for (const double f : {mode.frequency_low, 0.5 * (mode.frequency_low + mode.frequency_high), mode.frequency_high}) {
      if (residual_vibration(command, f, task.sample_period, mode.damping_low) > mode.residual_max * formula_slack)
        return false;
    }
  }
  for (const LimitUse& use : vibration_utilisation(command, task.sample_period, task.machine, stop)) {
    if (use.utilisation > formula_slack) return false;
  }
  return true;
}

int last_delay(const Task& task, int motion_order) {
  double more = 0.0;
  for (const Mode& mode : task.machine.modes) {
    if (mode.of_axis()) more = std::max(more, std::ceil(1.0 / (mode.frequency_low * task.sample_period)));
  }
  return motion_order + settling + static_cast<int>(std::min(more, 1e6));
}

std::optional<std::vector<int>> delays_by_formula(const Filter& filter, const Task& task, double samples,
                                                  const std::function<bool()>& stop) {
  const FilterBehind behind(filter, task.machine, task.sample_period);
  const DelayFinder smallest(behind.motion());
  std::vector<int> delays;
  const LinearCost linear = cost_of(task);
  for (const TaskCorner& corner : task.corners) {
    // If axes respond differently, any delay may hold an error.
    const int least =
        corner.error_max && !behind.differs()
            ? delay_for_error(smallest, corner.geometry(), task.sample_period, *corner.error_max * formula_slack)
            : 0;
    delays.push_back(corner.delay.value_or(least));
  }
  double cost = linear(filter.order(), delays);
  // The error bounds alone show which filters are too slow, before their limits are checked.
  const BlendLimits limits(filter, task.machine, task.sample_period);
  if (cost >= samples || !holds_without_blends(limits, filter, task, stop)) return std::nullopt;
  for (std::size_t j = 0; j < delays.size(); ++j) {
    const TaskCorner& corner = task.corners[j];
    // From N + 1 on, the legs do not overlap, but the last step of one acceleration still meets the first of the other.
    const int last = corner.delay.value_or(std::max(delays[j], last_delay(task, behind.longest_order())));
    BlendCheck check(behind, corner, task, limits);
    bool stopped = false;
    const auto holds = [&](int delay) { return !(stopped = stop && stop()) && check.holds(delay); };
    const auto ends = [&](int delay) {
      return stopped || !check.longer_may_hold(delay) || (cost += linear.delay[j]) >= samples;
    };
    const std::optional<int> found = first_delay(delays[j], last, holds, ends);
    if (!found) return std::nullopt;
    delays[j] = *found;
  }
  return delays;
}

}  // namespace accdec
