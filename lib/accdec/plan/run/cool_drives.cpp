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
#include <accdec/program.hpp>

namespace accdec {
namespace {

constexpr std::size_t groups_max = 12;     // of blocks that are slowed together
constexpr double trials_blocks_max = 5e6;  // blocks simulated while blocks are slowed
constexpr double trials_max = 400.0;       // simulated plans
constexpr double factor_max = 1000.0;      // of all durations
constexpr double first_step = 0.05;        // of the durations of a group
constexpr double growth = 1.05;            // of the step
constexpr double enough = 1e-3;            // of the durations

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

/// Slows blocks of a plan until its drives are cool.
class Cooling {
 public:
  Cooling(const ScheduledPlan& plan, const Filter& filter, double period, const Machine& machine,
          const std::function<void(ScheduledPlan&)>& check, const Deadline& deadline)
      : first_(plan),
        filter_(filter),
        period_(period),
        machine_(machine),
        behind_(filter, machine, period),
        check_(check),
        deadline_(deadline),
        group_(groups_of(plan.path)),
        groups_(*std::ranges::max_element(group_)) {}

  std::optional<ScheduledPlan> run() {
    together();
    apart();
    return std::move(best_);
  }

 private:
  struct Trial {
    ScheduledPlan plan;
    double excess = unlimited;  // sum of (rms / rating)^2 - 1 over drives that are too warm; unlimited: a limit breaks
  };
  double excess_of(const ScheduledPlan& plan) const {
    double sum = 0.0;
    for (const AxisLoad& load : loads_of(plan, behind_, filter_, period_, machine_))
      sum += std::max(0.0, load.rms * load.rms / (load.rms_max * load.rms_max) - 1.0);
    return sum;
  }
  static std::int64_t samples(const ScheduledPlan& plan) { return plan.plan.simulation.samples; }

  /// @param group  0: all
  Trial slowed(const ScheduledPlan& from, std::size_t group, double factor) {
    ++trials_;
    Trial trial{{from.path, {}}};
    for (std::size_t b = 0; b < group_.size(); ++b) {
      if (group == 0 || group_[b] == group) trial.plan.path.duration[b] *= factor;
    }
    trial.plan.plan.delays = from.plan.delays;
    check_(trial.plan);
    if (all_holds(trial.plan.plan)) trial.excess = excess_of(trial.plan);
    if (trial.excess <= 0.0 && (!best_ || samples(trial.plan) < samples(*best_))) best_ = trial.plan;
    return trial;
  }
  bool time_left() const {
    return trials_ < std::min(trials_max, trials_blocks_max / static_cast<double>(group_.size())) && !deadline_.over();
  }
  /// The least factor found with which slower blocks keep the ratings. Slower is not always cooler: a resting drive
  /// cools most while others move, so factors are tried from below.
  void least_factor(const ScheduledPlan& from, std::size_t group, double low, double high) {
    while (high > low * (1.0 + enough) && time_left()) {
      const double middle = std::sqrt(low * high);
      (slowed(from, group, middle).excess <= 0.0 ? high : low) = middle;
    }
  }

  /// All blocks by one factor.
  void together() {
    double low = 1.0, high = 1.05;
    while (high < factor_max && !deadline_.over() && !(slowed(first_, 0, high).excess <= 0.0))
      low = high, high = std::pow(high, 1.4);
    if (best_) least_factor(first_, 0, low, high);
  }

  /// Step by step the group that cools most for its time, or all of them.
  void apart() {
    Trial now{first_, excess_of(first_)};
    constexpr double times = 8.0;
    const double most = times * static_cast<double>(samples(first_));
    for (double step = first_step; now.excess > 0.0 && time_left(); step = std::min(1.0, step * growth)) {
      std::optional<Trial> next;
      std::size_t chosen = 0;
      double best_rate = 0.0;
      for (std::size_t group = 0; group <= groups_ && time_left(); ++group) {
        Trial trial = slowed(now.plan, group, 1.0 + step);
        const auto longer = static_cast<double>(std::max<std::int64_t>(1, samples(trial.plan) - samples(now.plan)));
        const double rate = (now.excess - trial.excess) / longer;
        if (rate > best_rate) best_rate = rate, chosen = group, next = std::move(trial);
      }
      if (!next || static_cast<double>(samples(next->plan)) > most) return;
      if (next->excess <= 0.0) least_factor(now.plan, chosen, 1.0, 1.0 + step);
      now = std::move(*next);
    }
  }

  const ScheduledPlan& first_;
  const Filter& filter_;
  double period_;
  const Machine& machine_;
  const FilterBehind behind_;
  const std::function<void(ScheduledPlan&)>& check_;
  const Deadline& deadline_;
  std::vector<std::size_t> group_;  // of every block
  std::size_t groups_;
  std::optional<ScheduledPlan> best_;
  double trials_ = 0.0;
};

}  // namespace

bool cool_drives(ScheduledPlan& plan, const Filter& filter, double sample_period, const Machine& machine,
                 const std::function<void(ScheduledPlan&)>& check, const Deadline& deadline) {
  if (!all_holds(plan.plan) || !has_ratings(machine)) return false;
  const FilterBehind behind(filter, machine, sample_period);
  const auto warm = [](const AxisLoad& load) { return load.rms > load.rms_max; };
  if (std::ranges::none_of(loads_of(plan, behind, filter, sample_period, machine), warm)) return false;
  std::optional<ScheduledPlan> cool = Cooling(plan, filter, sample_period, machine, check, deadline).run();
  if (!cool) return false;
  std::size_t slowed = 0;
  for (std::size_t b = 0; b < plan.path.blocks(); ++b) slowed += cool->path.duration[b] > plan.path.duration[b] ? 1 : 0;
  cool->plan.too_fast = std::move(plan.plan.too_fast);
  cool->plan.rounds = plan.plan.rounds;
  cool->plan.slowed = std::max(plan.plan.slowed, slowed);
  plan = std::move(*cool);
  return true;
}

}  // namespace accdec
