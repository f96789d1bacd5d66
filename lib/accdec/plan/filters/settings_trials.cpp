#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <accdec/machine/response.hpp>
#include <accdec/motion/circle.hpp>
#include <accdec/plan/command/choose_feeds.hpp>
#include <accdec/plan/command/limited_repair.hpp>
#include <accdec/plan/command/slow_blocks.hpp>
#include <accdec/plan/delays/control_delays.hpp>
#include <accdec/plan/feeds/control_delay.hpp>
#include <accdec/plan/filters/settings_members.hpp>
#include <accdec/plan/filters/settings_trials.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

/// Programs of at most so many blocks are planned at the programmed feeds, too, and repaired to the end.
constexpr std::size_t small_program = 2'000;

// Work of plans, s, as measured on programs of 200 to 9000 blocks. It differs by a factor of two or so.

double work_of_schedule(const ScheduledPlan& plan) {
  return 2e-4 + 1.5e-6 * static_cast<double>(plan.path.blocks()) * (plan.plan.rounds + 1);
}
double work_of_kept(const Toolpath& path, const LimitedPlan& plan) {
  return 4e-4 + 3e-6 * static_cast<double>(path.blocks()) + 2.5e-6 * plan.repairs;
}
/// The same for the waits of one plan for a width: the way left is taken after each possible wait at each joint.
double work_of_waits(const Toolpath& path, const Filter& filter) {
  const double n = filter.order();
  return path.control.width > 0.0 ? static_cast<double>(path.blocks()) * n * (1e-9 * n + 3e-8) : 0.0;
}
constexpr double repairs_a_block = 50.0;  // more than plans that hold need
/// Samples, between delays that are tried first.
int coarse_delays(const Filter& filter) {
  return std::max(1, filter.order() / 8);
}

}  // namespace

SettingsTrials::SettingsTrials(const Toolpath& path, const Task& task, bool keep, Effort& effort)
    : path_(path),
      task_(task),
      machine_(program_machine(task.machine, path)),
      keep_(keep),
      effort_(effort),
      feed_step_(corner_feed_step_of(task.settings)) {
  double time = 0.0;
  for (std::size_t b = 0; b < path.blocks(); ++b) {
    time += path.duration[b];
    if (path.joint[b] == Joint::stop && b + 1 < path.blocks()) ++stops_;
    if (b + 1 == path.blocks() || path.joint[b] != Joint::corner) continue;
    const bool by_axis = task.settings && task.settings->in_position_by_axis;
    step_ = std::max(step_, sample_way(path, b, task.sample_period, by_axis));
  }
  for (std::size_t b = 0; b < path.blocks(); ++b) {
    if (path.rapid[b] == 0) fastest_ = std::max(fastest_, path.length(b) / path.duration[b]);
  }
  moving_ = std::floor(time * (1.0 - snapped_part) / task.sample_period);
}

std::vector<SettableMember> SettingsTrials::at_feed(const SettableMembers& members) const {
  double acceleration = unlimited, jerk = unlimited;
  for (const Axis& axis : machine_.axes)
    acceleration = std::min(acceleration, axis.acceleration_max), jerk = std::min(jerk, axis.jerk_max);
  if (!(acceleration < unlimited)) return {};
  return members.at_feed(fastest_, acceleration, jerk);
}

std::optional<Filter> SettingsTrials::command(const Filter& set) const {
  Filter filter = Response(task_.machine, task_.sample_period).command(set);
  const std::vector<LimitUse> uses = vibration_utilisation(filter, task_.sample_period, machine_);
  const bool rings = std::any_of(uses.begin(), uses.end(),
                                 [](const LimitUse& use) { return use.utilisation > 1.0 + verification_tolerance; });
  if (rings) return std::nullopt;
  return filter;
}

bool SettingsTrials::guesses_kept() const {
  return keep_ || path_.blocks() <= small_program;
}

bool SettingsTrials::has_widths() const {
  return task_.settings->names(DelayKind::in_position) && step_ > 0.0;
}

double SettingsTrials::width_of(const Filter& filter, int delay) const {
  const double more = delay > 0 ? filter.remaining_moment(delay - 1) : filter.remaining_moment(0) + 1.0;
  return 0.5 * step_ * (filter.remaining_moment(delay) + more);
}

/// Steps around a delay of the fastest corner that are halved.
template <class Time>
void SettingsTrials::search_width(const Filter& filter, int from, int step, const Time& time,
                                  TimedSetting& best) const {
  for (; step >= 1; step /= 2) {
    for (const int delay : {from - step, from + step}) {
      if (delay < 0 || delay > filter.order() || effort_.over()) continue;
      const double width = width_of(filter, delay), samples = time(planned_control(*task_.settings, width));
      if (samples < best.samples) best = {samples, width}, from = delay;
    }
  }
}

int SettingsTrials::delay_at(const Filter& filter, double width) const {
  int delay = filter.order();
  while (delay > 0 && width_of(filter, delay) < width * (1.0 - 1e-9)) --delay;
  return delay;
}

double SettingsTrials::any(const Filter& set) const {
  const std::optional<Filter> filter = command(set);
  if (!filter) return unlimited;
  const double chosen = keep_ ? unlimited : scheduled(*filter, {});
  return guesses_kept() ? std::min(chosen, kept(*filter)) : chosen;
}

double SettingsTrials::kept(const Filter& filter) const {
  const PairwiseTimes times(path_, filter, task_.sample_period, machine_, effort_, false);
  if (!times.curves_delayed()) return times.any();
  // Lower feeds on curves may take less time than delays.
  const auto lost = [&] { return lost_on_curves(path_, filter, task_.sample_period, machine_, effort_); };
  return std::min(times.any(), times.any_slowed(lost_.at(std::sqrt(tap_variance(filter)), lost)));
}

TimedSetting SettingsTrials::guess(const Filter& set, double any, double width) const {
  const std::optional<Filter> behind = any < unlimited ? command(set) : std::nullopt;
  const ControlDelays control = planned_control(*task_.settings, 0.0);
  if (!behind || control.any()) return {any, 0.0};
  const Filter& filter = *behind;
  std::optional<PairwiseTimes> pairwise;
  if (guesses_kept()) pairwise.emplace(path_, filter, task_.sample_period, machine_, effort_, true);
  const auto time = [&](const ControlDelays& with) {
    const double chosen = keep_ ? unlimited : scheduled(filter, with);
    return pairwise ? std::min(chosen, pairwise->with(with)) : chosen;
  };
  TimedSetting best{time(control), 0.0};
  if (!has_widths()) return best;
  const auto take = [&](int delay) {
    const double at = width_of(filter, delay), samples = time(planned_control(*task_.settings, at));
    const bool better = samples < best.samples;
    if (better) best = {samples, at};
    return better;
  };
  const int coarse = coarse_delays(filter);
  if (width > 0.0) {
    const int near = delay_at(filter, width);
    take(near);
    search_width(filter, near, coarse, time, best);
    return best;
  }
  int middle = filter.order() / 2;
  for (int delay = 0; delay <= filter.order() && !effort_.over(); delay += coarse) {
    if (take(delay)) middle = delay;
  }
  search_width(filter, middle, coarse / 2, time, best);
  return best;
}

TimedSetting SettingsTrials::plan(const Filter& set, double guessed, bool thorough) const {
  const std::optional<Filter> filter = command(set);
  if (!filter) return {};
  const Deadline until = thorough ? with_one_plan(effort_.clock()) : effort_.clock();
  const ControlDelays control = planned_control(*task_.settings, guessed);
  TimedSetting best{planned(*filter, control, until), guessed};
  if (control.any() || !has_widths()) return best;
  if (!thorough || best.samples < unlimited) return best;
  // The longest delays, which most limits allow, come first. A plan with short ones may hold by far lower feeds.
  const int coarse = coarse_delays(*filter);
  for (int delay = filter->order(); delay >= 0 && !effort_.over(); delay -= coarse) {
    const double width = width_of(*filter, delay);
    const double samples = planned(*filter, planned_control(*task_.settings, width), effort_.clock());
    if (samples < best.samples) best = {samples, width};
  }
  return best;
}

TimedSetting SettingsTrials::refined(const Filter& set, const TimedSetting& planned) const {
  const std::optional<Filter> filter = command(set);
  const bool any = planned_control(*task_.settings, planned.width).any();
  if (!filter || any || !has_widths() || !(planned.width > 0.0)) return planned;
  TimedSetting best = planned;
  const auto time = [&](const ControlDelays& with) { return this->planned(*filter, with, effort_.clock()); };
  search_width(*filter, delay_at(*filter, best.width), std::max(1, coarse_delays(*filter) / 2), time, best);
  return best;
}

double SettingsTrials::scheduled(const Filter& filter, const ControlDelays& control) const {
  Toolpath path = path_;
  path.control = control;
  const ScheduledPlan plan =
      schedule_feeds(path, filter, task_.sample_period, machine_, 0, effort_.clock(), feed_step_);
  effort_.spend(work_of_schedule(plan));
  return static_cast<double>(plan.plan.simulation.samples);
}

double SettingsTrials::planned(const Filter& filter, const ControlDelays& control, const Deadline& until) const {
  Toolpath path = path_;
  path.control = control;
  double best = unlimited;
  const auto take = [&](const Toolpath& planned, ProgramPlan plan) {
    settle_delays(planned, filter, task_.sample_period, machine_, plan);
    constexpr double settled = 2.0;  // here and in the plan
    effort_.spend(settled * work_of_waits(planned, filter));
    if (all_holds(plan) && corner_feeds_had(planned, path_, plan.delays, feed_step_))
      best = std::min(best, static_cast<double>(plan.simulation.samples));
  };
  const bool small = path.blocks() <= small_program;
  if (!keep_) {
    const ScheduledPlan chosen =
        schedule_feeds(path, filter, task_.sample_period, machine_, small ? 40 : 3, until, feed_step_);
    effort_.spend(work_of_schedule(chosen));
    take(chosen.path, chosen.plan);
  }
  if (keep_ || small) {
    limit_rapids(path, filter, task_.sample_period, machine_);
    snap_durations(path, filter, task_.sample_period, machine_);
    const double repairs_max = repairs_a_block * static_cast<double>(path.blocks());
    LimitedPlan plan = plan_with_limited_repair(path, filter, task_.sample_period, machine_, until, repairs_max);
    effort_.spend(work_of_kept(path, plan));
    take(path, std::move(plan.plan));
  }
  return best;
}

}  // namespace accdec
