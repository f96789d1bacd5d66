#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>

#include <accdec/machine/mode_text.hpp>
#include <accdec/plan/command/program_plan.hpp>
#include <accdec/plan/result/other_rules.hpp>
#include <accdec/simulate/sample_check.hpp>
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

}  // namespace

OtherRules other_rules(const Toolpath& path, const Filter& filter, double sample_period, const Machine& machine) {
  OtherRules times;
  std::vector<int> none = pairwise_delays(path, filter, sample_period, machine, DelayRule::none).delays;
  // Plans stop as briefly as this where it does.
  const int stop = std::max(0, filter.last_nonzero_tap() - filter.first_nonzero_tap());
  for (int& delay : none) delay = std::min(delay, stop);
  times.no_delay =
      static_cast<double>(motion_samples(CommandTiming(path, sample_period, none), filter)) * sample_period;
  std::vector<int> delays = pairwise_delays(path, filter, sample_period, machine, DelayRule::exact_stop).delays;
  for (const int more : {0, 1}) {
    for (int& delay : delays) delay += delay > 0 ? more : 0;
    const ProgramPlan plan = check_program(path, filter, sample_period, machine, delays);
    times.exact_stop = static_cast<double>(plan.simulation.samples) * sample_period;
    const std::string limit = broken_most(plan.simulation.limits), tolerance = tolerance_broken_most(path, plan);
    times.breaks = limit + (limit.empty() || tolerance.empty() ? "" : " and ") + tolerance;
    if (limit.empty()) break;
  }
  return times;
}

}  // namespace accdec
