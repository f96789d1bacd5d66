#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>

#include <accdec/machine/limits.hpp>
#include <accdec/machine/mode_text.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/plan/command/program_plan.hpp>
#include <accdec/plan/run/other_rules.hpp>
#include <accdec/program.hpp>
#include <accdec/simulate/sample_check.hpp>
#include <accdec/simulate/simulate.hpp>
#include <accdec/task/blend_limits.hpp>
#include <accdec/task/delay_kinds.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

/// The limit of an axis or of the supply; empty if all hold.
std::string broken_most(const std::vector<LimitUse>& uses) {
  double worst = 1.0 + verification_tolerance;
  std::string name;
  for (const LimitUse& use : uses) {
    if (use.utilisation <= worst) continue;
    worst = use.utilisation;
    name = limit_and_axis(use);
  }
  return name;
}

/// Stops leave no corner error, but inside arcs and along curves the motion does not stop. Empty if all hold.
std::string tolerance_broken_most(const Toolpath& path, const ProgramPlan& plan) {
  double worst = 0.0;
  std::string name;
  for (std::size_t b = 0; b + 1 < path.blocks(); ++b) {
    if (holds(plan.errors[b], path.tolerance[b])) continue;
    const double use = plan.errors[b] / path.tolerance[b];
    if (use <= worst) continue;
    worst = use;
    name = fmt::format("the tolerance in line {}", path.line[b]);
  }
  return name;
}

/// Whether exact stops surely hold, without simulating them. The motion of a block is that of its start less that of
/// its stop, some samples later. Taps are not negative, so the speed and the acceleration of both together are at most
/// those of one of them. The jerk is at most twice that of one. So is that of a stop with the next start.
bool stops_surely_hold(const Toolpath& path, const Filter& filter, double sample_period, const Machine& machine) {
  const bool inside_arcs = std::ranges::any_of(path.inside_arc, [](auto inside) { return inside != 0; });
  if (inside_arcs || path.contour_max < unlimited || !FilterBehind(filter, machine, sample_period).ideal() ||
      limits_supply(machine) || has_mode_of_axis(machine))
    return false;
  Machine halved = machine;
  for (Axis& axis : halved.axes) {
    for (const AxisLimit& limit : axis_limits)
      if (limit.load && axis.*limit.bound < unlimited) return false;
    axis.jerk_max *= 0.5;
  }
  const BlendLimits limits(filter, halved, sample_period);
  const std::size_t n = path.dimensions();
  std::vector<double> velocity(n);
  for (std::size_t b = 0; b < path.blocks(); ++b) {
    for (std::size_t a = 0; a < n; ++a) velocity[a] = (path.point(b + 1)[a] - path.point(b)[a]) / path.duration[b];
    if (limits.start_factor(velocity.data()) < 1.0) return false;
  }
  return true;
}

/// The limit that the first blocks break most; empty if they hold all. If they break one, all of them do, and need not
/// be simulated to know it.
std::string broken_at_first(const Toolpath& path, const Filter& filter, double sample_period, const Machine& machine,
                            const std::vector<int>& delays) {
  if (machine.axes.empty()) return "";
  const CommandTiming timing(path, sample_period, delays);
  const std::size_t last = timing.run_end(path.blocks() / 16);
  std::vector<double> errors(path.blocks(), 0.0);
  SimulationOptions options;
  options.machine = &machine;
  options.blame = true;
  const FilterBehind behind(filter, machine, sample_period);
  options.motion = behind.servo();
  const Simulation first = simulate_program(timing, filter, 0, last, errors, options);
  // The motion at the end of the last of them depends on what follows it.
  const bool broken = !first.broken.empty() && first.broken.front() < last;
  return broken ? broken_most(first.limits) : "";
}

}  // namespace

OtherRules other_rules(const Toolpath& path, const Filter& filter, double sample_period, const Machine& machine) {
  OtherRules times;
  std::vector<int> none = pairwise_delays(path, filter, sample_period, machine, DelayRule::none).delays;
  // Plans stop as briefly as this where it does.
  const int stop = exact_stop_delay(filter);
  for (int& delay : none) delay = std::min(delay, stop);
  const auto seconds_with = [&](const std::vector<int>& delays) {
    return static_cast<double>(motion_samples(CommandTiming(path, sample_period, delays), filter)) * sample_period;
  };
  times.no_delay = seconds_with(none);
  std::vector<int> delays = pairwise_delays(path, filter, sample_period, machine, DelayRule::exact_stop).delays;
  if (stops_surely_hold(path, filter, sample_period, machine)) {
    times.exact_stop = seconds_with(delays);
    return times;
  }
  for (const int more : {0, 1}) {
    for (int& delay : delays) delay += delay > 0 ? more : 0;
    const bool part = more == 0 || path.blocks() > several_plans_max;
    std::string limit = part ? broken_at_first(path, filter, sample_period, machine, delays) : "";
    if (more == 0 && !limit.empty()) continue;
    if (!limit.empty()) {
      times.exact_stop = seconds_with(delays);
      times.breaks = std::move(limit);
      break;
    }
    const ProgramPlan plan = check_program(path, filter, sample_period, machine, delays, false);
    times.exact_stop = static_cast<double>(plan.simulation.samples) * sample_period;
    limit = broken_most(plan.simulation.limits);
    const std::string tolerance = tolerance_broken_most(path, plan);
    times.breaks = limit + (limit.empty() || tolerance.empty() ? "" : " and ") + tolerance;
    if (limit.empty()) break;
  }
  return times;
}

}  // namespace accdec
