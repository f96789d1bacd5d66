#include <fmt/format.h>

#include <accdec/plan/command/program_plan.hpp>
#include <accdec/plan/result/other_rules.hpp>
#include <accdec/verify.hpp>

namespace accdec {

OtherRules other_rules(const Toolpath& path, const Filter& filter, double sample_period, const Machine& machine) {
  OtherRules times;
  const std::vector<int> none = pairwise_delays(path, filter, sample_period, machine, DelayRule::none).delays;
  times.no_delay =
      static_cast<double>(motion_samples(CommandTiming(path, sample_period, none), filter)) * sample_period;
  std::vector<int> delays = pairwise_delays(path, filter, sample_period, machine, DelayRule::exact_stop).delays;
  for (const int more : {0, 1}) {
    for (int& delay : delays) delay += delay > 0 ? more : 0;
    const ProgramPlan plan = check_program(path, filter, sample_period, machine, delays);
    times.exact_stop = static_cast<double>(plan.simulation.samples) * sample_period;
    double worst = 1.0 + verification_tolerance;
    times.breaks.clear();
    for (const LimitUse& use : plan.simulation.limits) {
      if (use.utilisation <= worst) continue;
      worst = use.utilisation;
      times.breaks = fmt::format("{} {}", to_string(use.kind), use.axis);
    }
    if (times.breaks.empty()) break;
  }
  return times;
}

}  // namespace accdec
