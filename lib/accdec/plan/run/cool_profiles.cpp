#include <algorithm>
#include <cmath>
#include <utility>

#include <accdec/plan/report/axis_loads.hpp>
#include <accdec/plan/run/cool_profiles.hpp>
#include <accdec/plan/run/cooling.hpp>

namespace accdec {
namespace {

constexpr double replans_max = 200.0;          // whole plans
constexpr double replanned_samples_max = 1e7;  // of them all

void slow_feeds(Toolpath& path, Machine& machine, double factor) {
  for (double& duration : path.duration) duration *= factor;
  for (Axis& axis : machine.axes) axis.velocity_max /= factor;
}

/// So that ramps to feeds as much lower take so many times longer.
void slow_ramps(Axis& axis, double factor) {
  const double most = std::min(axis.acceleration_max, axis.mass > 0.0 ? axis.force_max / axis.mass : unlimited);
  if (most < unlimited)
    axis.acceleration_max = most / (factor * factor);
  else
    axis.jerk_max /= factor * factor * factor;
}

double excess_of(const Toolpath& path, const ProfilePlan& plan, const Machine& machine, double sample_period) {
  if (!plan.checked || !plan.holds()) return unlimited;
  ProgramResult result;
  result.sample_period = sample_period;
  result.check.samples = plan.check.samples;
  result.plan = {path, Trajectory{plan.chain, plan.last}};
  return excess_of(axis_loads(result, machine));
}

}  // namespace

void slow_down(Toolpath& path, Machine& machine, double factor) {
  slow_feeds(path, machine, factor);
  for (Axis& axis : machine.axes) slow_ramps(axis, factor);
}

std::optional<CoolProfiles> cool_profiles(const Toolpath& path, const Machine& machine, double sample_period,
                                          const ProfilePlan& plan, const Deadline& deadline) {
  if (!has_ratings(machine)) return {};
  CoolProfiles first{path, machine, plan, plan.check.samples, excess_of(path, plan, machine, sample_period)};
  if (!(first.excess > 0.0 && first.excess < unlimited)) return {};
  // All feeds are one group, the acceleration of every axis is another.
  const auto slowed = [&](const CoolProfiles& from, std::size_t group, double factor) {
    CoolProfiles slow{from.path, from.machine, {}};
    if (group == 0) slow_down(slow.path, slow.machine, factor);
    if (group == 1) slow_feeds(slow.path, slow.machine, factor);
    if (group >= 2) slow_ramps(slow.machine.axes[group - 2], factor);
    slow.plan = plan_profiles(slow.path, slow.machine, sample_period, deadline);
    slow.samples = slow.plan.check.samples;
    slow.excess = excess_of(slow.path, slow.plan, machine, sample_period);
    return slow;
  };
  const double trials =
      std::min(replans_max, replanned_samples_max / static_cast<double>(std::max<std::int64_t>(1, first.samples)));
  return Cooling<CoolProfiles>(std::move(first), machine.axes.size() + 1, trials, slowed, deadline).run();
}

}  // namespace accdec
