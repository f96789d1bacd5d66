#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include <accdec/machine/response.hpp>
#include <accdec/motion/circle.hpp>
#include <accdec/motion/least_held.hpp>
#include <accdec/plan/command/choose_feeds.hpp>
#include <accdec/plan/command/limited_repair.hpp>
#include <accdec/plan/command/slow_blocks.hpp>
#include <accdec/plan/delays/control_delays.hpp>
#include <accdec/plan/feeds/control_delay.hpp>
#include <accdec/plan/filters/settings_members.hpp>
#include <accdec/plan/filters/settings_trials.hpp>
#include <accdec/plan/filters/width_choices.hpp>
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
double work_of_widths(const std::vector<WidthChoice>& widths) {
  return 1e-7 * static_cast<double>(widths.size());
}

/// Widths, between those that are tried first.
int coarse_step(const std::vector<WidthChoice>& widths) {
  return std::max(1, static_cast<int>(widths.size()) / 8);
}

/// The same, for those that are tried last where feeds are chosen: thresholds of programmed feeds are none of them.
int finest_step(const std::vector<WidthChoice>& widths, const Filter& filter) {
  return std::max(1, static_cast<int>(widths.size()) / std::max(1, 4 * filter.order()));
}

/// The widest with the fewest samples; null: none has a time.
const WidthChoice* best_of(const std::vector<WidthChoice>& widths) {
  const auto best = std::ranges::min_element(widths, {}, &WidthChoice::samples);
  return best != widths.end() && best->samples < unlimited ? &*best : nullptr;
}

/// The last that is no narrower.
int nearest_to(const std::vector<WidthChoice>& widths, double width) {
  const auto narrower =
      std::ranges::find_if(widths, [&](const WidthChoice& choice) { return choice.width < width * (1.0 - 1e-9); });
  return std::max(0, static_cast<int>(narrower - widths.begin()) - 1);
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
    joints_.push_back({sample_way(path, b, task.sample_period, by_axis()), 0});
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

bool SettingsTrials::by_axis() const {
  return task_.settings && task_.settings->in_position_by_axis;
}

bool SettingsTrials::has_widths() const {
  return task_.settings->names(DelayKind::in_position) && !joints_.empty();
}

std::vector<WidthChoice> SettingsTrials::widths_of(const Filter& filter) const {
  const ControlDelays control = control_of(task_, 0.0);
  if (!guesses_kept()) return width_choices(control, filter, joints_);
  return PairwiseTimes(path_, filter, task_.sample_period, machine_, effort_, by_axis(), true).widths(control);
}

/// Steps around a width that are halved.
/// @param finest  the last of them
template <class Time>
void SettingsTrials::search_width(const std::vector<WidthChoice>& widths, int from, int step, int finest,
                                  const Time& time, TimedSetting& best) const {
  for (; step >= finest; step /= 2) {
    for (const int at : {from - step, from + step}) {
      if (at < 0 || at >= std::ssize(widths) || effort_.over()) continue;
      const double width = widths[static_cast<std::size_t>(at)].width;
      const double samples = time(planned_control(task_, width));
      if (samples < best.samples) best = {samples, width}, from = at;
    }
  }
}

double SettingsTrials::any(const Filter& set, double enough) const {
  const std::optional<Filter> filter = command(set);
  if (!filter) return unlimited;
  const double chosen = keep_ ? unlimited : scheduled(*filter, {});
  return guesses_kept() ? std::min(chosen, kept(*filter, enough)) : chosen;
}

double SettingsTrials::kept(const Filter& filter, double enough) const {
  const PairwiseTimes times(path_, filter, task_.sample_period, machine_, effort_, by_axis(), false);
  if (!times.curves_delayed()) return times.any();
  // Lower feeds on curves may take less time than delays.
  const double spread = std::sqrt(tap_variance(filter)), least = times.any_slowed(lost_.least(spread));
  if (least >= enough) return std::min(times.any(), least);
  const auto lost = [&] { return lost_on_curves(path_, filter, task_.sample_period, machine_, effort_); };
  return std::min(times.any(), times.any_slowed(lost_.at(spread, lost)));
}

TimedSetting SettingsTrials::guess(const Filter& set, double any, double width) const {
  const std::optional<Filter> behind = any < unlimited ? command(set) : std::nullopt;
  const ControlDelays control = planned_control(task_, 0.0);
  if (!behind || control.any()) return {any, 0.0};
  const Filter& filter = *behind;
  std::optional<PairwiseTimes> pairwise;
  if (guesses_kept()) pairwise.emplace(path_, filter, task_.sample_period, machine_, effort_, by_axis(), true);
  const auto time = [&](const ControlDelays& with) {
    const double chosen = keep_ ? unlimited : scheduled(filter, with);
    return pairwise ? std::min(chosen, pairwise->with(with)) : chosen;
  };
  TimedSetting best{time(control), 0.0};
  if (!has_widths()) return best;
  const std::vector<WidthChoice> widths =
      pairwise ? pairwise->widths(control_of(task_, 0.0)) : width_choices(control_of(task_, 0.0), filter, joints_);
  effort_.spend(work_of_widths(widths));
  if (const WidthChoice* kept = pairwise ? best_of(widths) : nullptr; kept != nullptr && kept->samples < best.samples)
    best = {kept->samples, kept->width};
  if (keep_ || widths.empty()) return best;
  const auto take = [&](int at) {
    const double tried = widths[static_cast<std::size_t>(at)].width;
    const double samples = time(planned_control(task_, tried));
    const bool better = samples < best.samples;
    if (better) best = {samples, tried};
    return better;
  };
  const int coarse = coarse_step(widths), finest = finest_step(widths, filter);
  if (width > 0.0) {
    const int near = nearest_to(widths, width);
    take(near);
    search_width(widths, near, coarse, finest, time, best);
    return best;
  }
  int middle = static_cast<int>(widths.size()) / 2;
  for (int at = 0; at < std::ssize(widths) && !effort_.over(); at += coarse) {
    if (take(at)) middle = at;
  }
  search_width(widths, middle, coarse / 2, finest, time, best);
  return best;
}

/// Plans with a width. @return its samples
double SettingsTrials::try_width(const Filter& filter, double width, TimedSetting& best) const {
  const double samples = planned(filter, planned_control(task_, width), effort_.clock());
  if (samples < best.samples) best = {samples, width};
  return samples;
}

/// Widths in the order of their guesses, those below `than` samples. The best one may break a limit where moves overlap
/// or where a longer delay is worse; the next one may hold.
void SettingsTrials::try_guesses(const Filter& filter, const std::vector<WidthChoice>& widths, int most, double than,
                                 TimedSetting& best) const {
  std::vector<WidthChoice> promising;
  for (const WidthChoice& choice : widths) {
    if (choice.samples < std::min(best.samples, than)) promising.push_back(choice);
  }
  std::ranges::stable_sort(promising, {}, &WidthChoice::samples);
  for (const WidthChoice& choice : promising) {
    if (most-- == 0 || effort_.over() || !(choice.samples < best.samples)) return;
    try_width(filter, choice.width, best);
  }
}

TimedSetting SettingsTrials::plan(const Filter& set, double guessed, bool thorough, double than) const {
  const std::optional<Filter> filter = command(set);
  if (!filter) return {};
  const Deadline until = thorough ? with_one_plan(effort_.clock()) : effort_.clock();
  const ControlDelays control = planned_control(task_, guessed);
  TimedSetting best{planned(*filter, control, until), guessed};
  if (control.any() || !has_widths() || !(keep_ || (thorough && !(best.samples < unlimited)))) return best;
  const std::vector<WidthChoice> widths = widths_of(*filter);
  if (best.samples < unlimited) {
    constexpr int most = 4;
    try_guesses(*filter, widths, most, than, best);
    return best;
  }
  const auto take = [&](int at) {
    return try_width(*filter, widths[static_cast<std::size_t>(at)].width, best) < unlimited;
  };
  // The longest delays, which most limits allow, come first. Errors and limits then hold up to the widest that does.
  const int wide = guessed > 0.0 ? nearest_to(widths, guessed) : -1;
  int narrow = static_cast<int>(widths.size()) - 1;
  const bool at_feed = keep_ && best_of(widths) != nullptr;
  if (!thorough && !at_feed) return best;
  while (at_feed && narrow > wide && !(widths[static_cast<std::size_t>(narrow)].samples < than)) --narrow;
  if (narrow > wide && !effort_.over() && take(narrow))
    least_held(wide, narrow, [&](int at) { return !effort_.over() && take(at); });
  // A plan with short ones may hold by far lower feeds.
  for (int at = narrow - coarse_step(widths); !at_feed && at >= 0 && !effort_.over(); at -= coarse_step(widths))
    take(at);
  return best;
}

TimedSetting SettingsTrials::refined(const Filter& set, const TimedSetting& planned) const {
  const std::optional<Filter> filter = command(set);
  const bool any = planned_control(task_, planned.width).any();
  if (!filter || any || !has_widths() || !(planned.width > 0.0)) return planned;
  const std::vector<WidthChoice> widths = widths_of(*filter);
  const WidthChoice* const kept = keep_ ? best_of(widths) : nullptr;
  if (widths.empty() || (kept != nullptr && planned.samples <= kept->samples)) return planned;
  TimedSetting best = planned;
  const auto time = [&](const ControlDelays& with) { return this->planned(*filter, with, effort_.clock()); };
  const int finest = keep_ ? 1 : finest_step(widths, *filter), coarse = std::max(finest, coarse_step(widths) / 2);
  if (keep_) {
    constexpr int most = 12;
    try_guesses(*filter, widths, most, unlimited, best);
  }
  search_width(widths, nearest_to(widths, best.width), coarse, finest, time, best);
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
  // Feeds may be chosen that no delay of the control suits.
  if (keep_ || small || !(best < unlimited)) {
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
