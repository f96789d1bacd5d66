#include <algorithm>
#include <cmath>

#include <accdec/plan/command/stop_everywhere.hpp>
#include <accdec/plan/feeds/contour_feeds.hpp>
#include <accdec/plan/feeds/control_delay.hpp>
#include <accdec/simulate/command_stream.hpp>
#include <accdec/task/blend_limits.hpp>
#include <accdec/task/delay_kinds.hpp>

namespace accdec {
namespace {

/// Lengthens delays at which modes of axes swing on by what both legs leave together.
void part_by_phase(const Toolpath& path, const BlendLimits& limits, std::vector<int>& delays) {
  const std::size_t n = path.dimensions();
  const auto velocity = [&](std::size_t b) {
    std::vector<double> v(n);
    for (std::size_t a = 0; a < n; ++a) v[a] = (path.point(b + 1)[a] - path.point(b)[a]) / path.duration[b];
    return v;
  };
  for (std::size_t b = 0; b + 1 < path.blocks(); ++b) {
    bool possible = true;
    delays[b] =
        limits.smallest(velocity(b).data(), velocity(b + 1).data(), delays[b], possible, path.joint[b] == Joint::stop);
  }
}

/// The plan's feeds and delays, not simulated.
ScheduledPlan with_stops(const Toolpath& path, const Filter& filter, double sample_period, const Machine& machine) {
  ScheduledPlan result{path, {}};
  const std::vector<double> parts =
      parts_within_contour(path, FilterBehind(filter, machine, sample_period), sample_period);
  for (std::size_t b = 0; b < path.blocks(); ++b) result.path.duration[b] /= parts[b];
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
    const auto had = [&](int least) {
      return control_delay(path.control, filter, length / duration * sample_period, least);
    };
    // The end of a block and the next start may add up if the exact stop of the control is shorter than that.
    if (limits.any() && (duration < apart * sample_period || !had(apart))) duration *= 2.0;
    if (duration > path.duration[b]) ++slowed;
    if (b + 1 < path.blocks()) delays[b] = had(apart).value_or(had(exact_stop_delay(filter)).value_or(apart));
  }
  if (has_mode_of_axis(machine)) part_by_phase(result.path, limits, delays);
  for (const auto& [block, delay] : path.given_delays)
    delays[block] = std::max(delays[block], static_cast<int>(std::lround(std::min(delay / sample_period, 1e9))));
  result.plan.delays = std::move(delays);
  result.plan.slowed = slowed;
  return result;
}

}  // namespace

ScheduledPlan stop_everywhere(const Toolpath& path, const Filter& filter, double sample_period,
                              const Machine& machine) {
  ScheduledPlan result = with_stops(path, filter, sample_period, machine);
  const std::size_t slowed = result.plan.slowed;
  result.plan = check_program(result.path, filter, sample_period, machine, std::move(result.plan.delays));
  result.plan.slowed = slowed;
  return result;
}

double stop_everywhere_samples(const Toolpath& path, const Filter& filter, double sample_period,
                               const Machine& machine) {
  const ScheduledPlan plan = with_stops(path, filter, sample_period, machine);
  const CommandTiming timing(plan.path, sample_period, plan.plan.delays);
  return static_cast<double>(motion_samples(timing, filter));
}

}  // namespace accdec
