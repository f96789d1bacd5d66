#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include <accdec/machine/response.hpp>
#include <accdec/plan/command/program_plan.hpp>
#include <accdec/plan/report/axis_loads.hpp>
#include <accdec/plan/run/cool_drives.hpp>
#include <accdec/plan/run/cooling.hpp>
#include <accdec/program.hpp>

namespace accdec {
namespace {

constexpr std::size_t groups_max = 12;     // of blocks that are slowed together
constexpr double trials_blocks_max = 5e6;  // blocks simulated while blocks are slowed

std::vector<AxisLoad> loads_of(const ScheduledPlan& plan, const FilterBehind& behind, const Filter& filter,
                               double sample_period, const Machine& machine) {
  ProgramResult result;
  result.sample_period = sample_period;
  result.check.samples = plan.plan.simulation.samples;
  FilteredCommand command{filter, plan.plan.delays};
  command.moved.assign(behind.servo().begin(), behind.servo().end());
  result.plan = {plan.path, std::move(command)};
  return axis_loads(result, machine);
}

/// The group of each block, from 1 on: its line. If a program has too many lines, those in which the same axis moves
/// most, at speeds of about the same power of two.
std::vector<std::size_t> groups_of(const Toolpath& path) {
  std::map<std::pair<std::size_t, int>, std::size_t> groups;
  std::vector<std::size_t> group(path.blocks());
  const auto number = [&](std::size_t b, std::pair<std::size_t, int> key) {
    group[b] = std::min(groups.try_emplace(key, groups.size() + 1).first->second, groups_max);
  };
  for (std::size_t b = 0; b < path.blocks() && groups.size() <= groups_max; ++b) number(b, {path.line[b], 0});
  if (groups.size() <= groups_max) return group;
  groups.clear();
  for (std::size_t b = 0; b < path.blocks(); ++b) {
    const double *from = path.point(b), *to = path.point(b + 1);
    std::size_t most = 0;
    for (std::size_t a = 1; a < path.dimensions(); ++a) {
      if (std::abs(to[a] - from[a]) > std::abs(to[most] - from[most])) most = a;
    }
    number(b, {most, std::ilogb(path.length(b) / path.duration[b])});
  }
  return group;
}

/// A plan while blocks are slowed.
struct Trial {
  ScheduledPlan plan;
  std::int64_t samples = 0;
  double excess = unlimited;
};

}  // namespace

Cooled cool_drives(ScheduledPlan& plan, const Filter& filter, double sample_period, const Machine& machine,
                   const std::function<void(ScheduledPlan&)>& check, const Deadline& deadline, double trials_max) {
  if (!all_holds(plan.plan) || !has_ratings(machine)) return Cooled::already;
  const FilterBehind behind(filter, machine, sample_period);
  const auto tried = [&](ScheduledPlan slower) {
    Trial trial{std::move(slower)};
    trial.samples = trial.plan.plan.simulation.samples;
    if (all_holds(trial.plan.plan))
      trial.excess = excess_of(loads_of(trial.plan, behind, filter, sample_period, machine));
    return trial;
  };
  Trial first = tried(plan);
  if (first.excess <= 0.0) return Cooled::already;
  const std::vector<std::size_t> group = groups_of(plan.path);
  const auto slower = [&](const Trial& from, std::size_t chosen, double factor) {
    ScheduledPlan trial{from.plan.path, {}};
    for (std::size_t b = 0; b < group.size(); ++b) {
      if (chosen == 0 || group[b] == chosen) trial.path.duration[b] *= factor;
    }
    trial.plan.delays = from.plan.plan.delays;
    check(trial);
    return tried(std::move(trial));
  };
  const double trials = std::min(trials_max, trials_blocks_max / static_cast<double>(group.size()));
  std::optional<Trial> found =
      Cooling<Trial>(std::move(first), *std::ranges::max_element(group), trials, slower, deadline).run();
  if (!found) return Cooled::failed;
  ScheduledPlan* const cool = &found->plan;
  std::size_t slowed = 0;
  for (std::size_t b = 0; b < plan.path.blocks(); ++b) slowed += cool->path.duration[b] > plan.path.duration[b] ? 1 : 0;
  cool->plan.too_fast = std::move(plan.plan.too_fast);
  cool->plan.rounds = plan.plan.rounds;
  cool->plan.slowed = std::max(plan.plan.slowed, slowed);
  plan = std::move(*cool);
  return Cooled::slowed;
}

}  // namespace accdec
