#include <algorithm>
#include <cmath>

#include <accdec/plan/command/stop_everywhere.hpp>
#include <accdec/plan/feeds/control_delay.hpp>
#include <accdec/task/blend_limits.hpp>

namespace accdec {

ScheduledPlan stop_everywhere(const Toolpath& path, const Filter& filter, double sample_period,
                              const Machine& machine) {
  ScheduledPlan result{path, {}};
  const BlendLimits limits(filter, machine, sample_period);
  const std::size_t n = path.dimensions();
  const int apart = filter.order() + 2;
  std::vector<double> velocity(n);
  std::vector<int> delays(path.blocks(), 0);
  std::size_t slowed = 0;
  for (std::size_t b = 0; b < path.blocks(); ++b) {
    double& duration = result.path.duration[b];
    const double* p = path.point(b);
    double length = 0.0;
    for (std::size_t a = 0; a < n; ++a) {
      velocity[a] = (p[n + a] - p[a]) / duration;
      length = std::hypot(length, p[n + a] - p[a]);
    }
    if (limits.any()) duration /= limits.start_factor(velocity.data());
    if (limits.any() && duration < apart * sample_period) duration *= 2.0;
    if (duration > path.duration[b]) ++slowed;
    if (b + 1 < path.blocks())
      delays[b] = control_delay(path.control, filter, length / duration * sample_period, apart).value_or(apart);
  }
  for (const auto& [block, delay] : path.given)
    delays[block] = std::max(delays[block], static_cast<int>(std::lround(std::min(delay / sample_period, 1e9))));
  result.plan = check_program(result.path, filter, sample_period, machine, std::move(delays));
  result.plan.slowed = slowed;
  return result;
}

}  // namespace accdec
