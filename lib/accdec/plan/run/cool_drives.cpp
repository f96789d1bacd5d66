#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <accdec/machine/response.hpp>
#include <accdec/plan/command/program_plan.hpp>
#include <accdec/plan/report/axis_loads.hpp>
#include <accdec/plan/run/cool_drives.hpp>
#include <accdec/program.hpp>

namespace accdec {

double warmest_drive(const ScheduledPlan& plan, const Filter& filter, double sample_period, const Machine& machine) {
  if (!has_ratings(machine)) return 0.0;
  const FilterBehind behind(filter, machine, sample_period);
  ProgramResult result;
  result.sample_period = sample_period;
  result.check.samples = plan.plan.simulation.samples;
  FilteredCommand command{filter, plan.plan.delays};
  command.moved.assign(behind.servo().begin(), behind.servo().end());
  result.plan = {plan.path, std::move(command)};
  double most = 0.0;
  for (const AxisLoad& load : axis_loads(result, machine)) most = std::max(most, load.rms / load.rms_max);
  return most;
}

bool cool_drives(ScheduledPlan& plan, const Filter& filter, double sample_period, const Machine& machine,
                 const std::function<void(ScheduledPlan&)>& check, const Deadline& deadline) {
  if (!all_holds(plan.plan) || warmest_drive(plan, filter, sample_period, machine) <= 1.0) return false;
  constexpr double most = 1000.0, enough = 1.0 + 1e-3;
  std::optional<ScheduledPlan> cool;
  const auto slowed_by = [&](double factor) {
    ScheduledPlan slower{plan.path, {}};
    for (double& duration : slower.path.duration) duration *= factor;
    slower.plan.delays = plan.plan.delays;
    check(slower);
    if (!all_holds(slower.plan) || warmest_drive(slower, filter, sample_period, machine) > 1.0) return false;
    cool = std::move(slower);
    return true;
  };
  double low = 1.0, high = 2.0;
  for (; !slowed_by(high); low = high, high *= 2.0) {
    if (high > most || deadline.over()) return false;
  }
  while (high > low * enough && !deadline.over()) {
    const double middle = std::sqrt(low * high);
    (slowed_by(middle) ? high : low) = middle;
  }
  cool->plan.too_fast = std::move(plan.plan.too_fast);
  cool->plan.rounds = plan.plan.rounds;
  cool->plan.slowed = plan.path.blocks();
  plan = std::move(*cool);
  return true;
}

}  // namespace accdec
