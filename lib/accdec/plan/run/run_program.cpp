#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include <accdec/bounds/filter_bound.hpp>
#include <accdec/bounds/lower_bound.hpp>
#include <accdec/files.hpp>
#include <accdec/gcode/emitted_filters.hpp>
#include <accdec/machine/limits.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/plan/command/choose_feeds.hpp>
#include <accdec/plan/command/program_plan.hpp>
#include <accdec/plan/command/stop_everywhere.hpp>
#include <accdec/plan/delays/control_delays.hpp>
#include <accdec/plan/delays/pairwise_delays.hpp>
#include <accdec/plan/feeds/control_delay.hpp>
#include <accdec/plan/feeds/stretches.hpp>
#include <accdec/plan/report/axis_loads.hpp>
#include <accdec/plan/run/before_planning.hpp>
#include <accdec/plan/run/cool_drives.hpp>
#include <accdec/plan/run/other_rules.hpp>
#include <accdec/plan/run/quiet_rests.hpp>
#include <accdec/plan/run/refused_keys.hpp>
#include <accdec/plan/verify/judge_program.hpp>
#include <accdec/program.hpp>
#include <accdec/simulate/simulate.hpp>
#include <accdec/task/delay_kinds.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

/// Trying every curve at several feeds takes ten times as long as one plan and saves a few percent. If a filter was
/// designed for chosen feeds, only programs this short do it, and only if programmed feeds are not this many times
/// slower.
constexpr std::size_t tuned_max = 2'000;
constexpr double hopelessly_slower = 1.25;
constexpr std::size_t parts_max = 4'000;  // blocks, of a long program, on which the programmed feeds are tried first
constexpr int feed_rounds_max = 40;       // of mending feeds
constexpr double stepping_time = 0.5;     // s, beyond the time limit, for the plan if no other holds

/// @param least  samples at a stop
std::vector<int> with_least_stops(const Toolpath& path, std::vector<int> delays, int least) {
  for (std::size_t b = 0; b + 1 < path.blocks(); ++b) {
    if (path.joint[b] == Joint::stop) delays[b] = std::min(delays[b], least);
  }
  return delays;
}

double seconds_of(const ProgramPlan& plan, double sample_period) {
  return static_cast<double>(plan.simulation.samples) * sample_period;
}

/// The rule of the control's exact stops, and the limit that they break at the programmed feeds.
std::string stop_that_breaks(const ProgramResult& result, int order) {
  if (!result.plan.path.control.names(DelayKind::exact_stop) || result.exact_stop_breaks.empty()) return "";
  return fmt::format(": its exact stop lasts {} samples until the filter is empty, or one longer, which breaks {}",
                     order, result.exact_stop_breaks);
}

/// Makes the plan of the result: the fastest requested plan that holds.
class Planning {
 public:
  /// @param programmed  until all plans are made
  /// @param set  without the control's own smoothing
  Planning(ProgramResult& result, const Toolpath& programmed, const Filter& set, const Task& task,
           const Machine& machine, const Deadline& deadline)
      : result_(result),
        programmed_(programmed),
        feed_step_(corner_feed_step_of(task.settings)),
        set_(set),
        filter_(Response(task.machine, task.sample_period).command(set)),
        behind_(filter_, machine, task.sample_period),
        task_(task),
        machine_(machine),
        deadline_(deadline) {}

  /// Plans at the programmed feeds, with rapid moves as fast as the filter can start and stop them.
  /// @param tune_curves  see plan_program
  void keep(const Toolpath& path, bool tune_curves) {
    if (!path.given_delays.empty()) as_commanded(path, false);
    base_ = path;
    limit_rapids(base_, filter_, task_.sample_period, machine_);
    snap_durations(base_, filter_, task_.sample_period, machine_);
    ProgramPlan plan = plan_program(base_, filter_, task_.sample_period, machine_, tune_curves, deadline_);
    ScheduledPlan kept{base_, std::move(plan)};
    snap(kept);
    quieten(kept);
    base_.duration = kept.path.duration;
    kept_ = seconds_of(kept.plan, task_.sample_period);
    if (all_holds(kept.plan)) result_.cycle_time_kept = kept_;
    offer(std::move(kept), false);
  }
  /// If --emit wrote this program and it holds as it is, it is the plan. False: it is planned like any other.
  bool as_written(const Toolpath& path, Feeds feeds) {
    const std::optional<Filter> written = emitted_filter(path);
    if (!written || !std::ranges::equal(written->taps(), set_.taps())) return false;
    as_commanded(path, feeds != Feeds::keep);
    return all_holds(best_.plan);
  }
  void choose(const Toolpath& path) {
    if (path.blocks() <= several_plans_max || !path.given_delays.empty()) as_commanded(path, true);
    ScheduledPlan plan =
        schedule_feeds(path, filter_, task_.sample_period, machine_, feed_rounds_max, deadline_, feed_step_);
    if (deadline_.over() && !all_holds(plan.plan)) {
      plan = schedule_feeds(path, filter_, task_.sample_period, machine_, feed_rounds_max,
                            Deadline(seconds_for_one_plan(path)), feed_step_);
    }
    chosen_ = all_holds(plan.plan);
    snap(plan);
    if (!kept_ && !all_holds(plan.plan) && !all_holds(best_.plan)) keep(path, false);
    offer(std::move(plan), true);
  }
  /// Programs too long to be planned twice in any case are planned at the programmed feeds, too, if that may be faster.
  void compare_kept(const Toolpath& path) {
    // Parts of the program are planned sooner than the least delays of all of it are found.
    if (kept_ || deadline_.over() || slower_in_parts(path)) return;
    if (least_kept(path) < best_.plan.simulation.samples) keep(path, true);
  }
  /// Offers a plan at the programmed feeds that held when the filter was chosen, if the time ended since.
  void as_known(const Toolpath& path, const KnownPlan& known) {
    const std::size_t blocks = path.blocks();
    if (!deadline_.over() || known.delays.size() != blocks || known.duration.size() != blocks) return;
    ScheduledPlan plan{path, {}};
    plan.path.duration = known.duration;
    plan.plan = check_program(plan.path, filter_, task_.sample_period, machine_, known.delays);
    plan.plan.slowed = known.slowed;
    snap(plan);
    if (!all_holds(plan.plan)) return;
    if (!result_.cycle_time_kept) {
      base_ = plan.path;
      result_.cycle_time_kept = kept_ = seconds_of(plan.plan, task_.sample_period);
    }
    offer(std::move(plan), false);
  }
  /// Plans again as `--feeds keep` does, so that chosen feeds are not slower.
  void tune(const Toolpath& path, Feeds feeds) {
    if (deadline_.over() || !kept_) return;
    const bool hopeless =
        path.blocks() > tuned_max || *kept_ > hopelessly_slower * seconds_of(best_.plan, task_.sample_period);
    if (feeds != Feeds::choose_fitting || !hopeless) keep(path, true);
  }
  /// If no plan holds, or the time ended before a good one was found: a slow one that stops at every joint.
  void stop(const Toolpath& path, bool feeds_chosen) {
    const bool ended = deadline_.over() && path.blocks() <= several_plans_max && !chosen_;
    // Steps of the feed inside the blocks save most of the time, if they are found quickly.
    if (feeds_chosen && (ended || !all_holds(best_.plan))) {
      auto steps = schedule_stops(path, filter_, task_.sample_period, machine_, Deadline(stepping_time));
      if (steps) offer(std::move(*steps), feeds_chosen);
    }
    if (!all_holds(best_.plan)) offer(stop_everywhere(path, filter_, task_.sample_period, machine_), feeds_chosen);
  }
  /// Lowers all feeds where a drive would be warmer over the program than its rating. The fastest plan need not be the
  /// one that is fastest once it is cool, so every plan that holds is cooled.
  void cool() {
    const auto again = [this](ScheduledPlan& plan) { check(plan); };
    // A plan that is too warm is none: it has a short time to cool if the limit ended before.
    const Deadline until = deadline_.over() ? Deadline(seconds_for_one_plan(best_.path)) : deadline_;
    const auto cooled = [&](ScheduledPlan& plan) {
      return cool_drives(plan, filter_, task_.sample_period, machine_, again, until);
    };
    const Cooled of_best = cooled(best_);
    if (of_best == Cooled::already) return;
    result_.cycle_time_kept.reset();  // that plan was not held against the ratings
    bool cool = of_best == Cooled::slowed;
    for (auto& [plan, feeds_chosen] : beside_) {
      const auto samples = plan.plan.simulation.samples;
      if (plan.path.programmed.empty() != best_.path.programmed.empty()) continue;  // widened arcs are better
      if ((cool && samples >= best_.plan.simulation.samples) || cooled(plan) == Cooled::failed) continue;
      if (cool && plan.plan.simulation.samples >= best_.plan.simulation.samples) continue;
      best_ = std::move(plan), cool = true;
      result_.feeds_chosen = feeds_chosen;
    }
    quieten(best_);
  }
  /// The plan as the result's.
  void take() {
    ProgramPlan& plan = best_.plan;
    delays_had_ = plan.delays_had;
    alone_ = std::move(plan.alone);
    result_.errors = std::move(plan.errors);
    result_.check.samples = plan.simulation.samples;
    result_.check.limits = std::move(plan.simulation.limits);
    result_.check.errors_hold = plan.errors_hold;
    result_.slowed = plan.slowed;
    result_.too_fast = std::move(plan.too_fast);
    result_.rounds = plan.rounds;
    FilteredCommand command{filter_, std::move(plan.delays)};
    if (!task_.machine.prefilter_taps.empty()) command.own = set_;
    command.moved.assign(behind_.servo().begin(), behind_.servo().end());
    result_.plan = {std::move(best_.path), std::move(command)};
  }

  /// Whether the control can give the delays of the plan taken.
  bool delays_had() const { return delays_had_; }
  /// Its delays of joints alone, see ProgramPlan.
  const std::vector<int>& alone() const { return alone_; }

  /// The times without delays and with exact stops, at the programmed feeds. If only the plan with chosen feeds was
  /// made, at its feeds.
  void other_rules() const {
    const Toolpath& at = result_.feeds_chosen && result_.cycle_time_kept ? base_ : result_.plan.path;
    OtherRules times = accdec::other_rules(at, filter_, task_.sample_period, machine_);
    result_.cycle_time_no_delay = times.no_delay;
    result_.cycle_time_exact_stop = times.exact_stop;
    result_.exact_stop_breaks = std::move(times.breaks);
  }

 private:
  /// Offers a plan with the program's own feeds and delays, unchanged. A program that --emit wrote holds this way.
  void as_commanded(const Toolpath& path, bool feeds_chosen) {
    ScheduledPlan plan{path, {}};
    if (!feeds_chosen) limit_rapids(plan.path, filter_, task_.sample_period, machine_);
    std::vector<int> delays(path.blocks(), 0);
    for (std::size_t b = 0; b + 1 < path.blocks(); ++b) {
      if (path.joint[b] == Joint::stop) delays[b] = exact_stop_delay(filter_);
    }
    for (const auto& [block, delay] : path.given_delays) {
      delays[block] = static_cast<int>(std::lround(std::min(delay / task_.sample_period, 1e9)));
    }
    plan.plan = check_program(plan.path, filter_, task_.sample_period, machine_, std::move(delays));
    snap(plan);
    if (all_holds(plan.plan)) offer(std::move(plan), feeds_chosen);
  }
  /// Runs that exceed whole samples by no more than rounding get these samples, if the plan then holds. The text that
  /// --emit writes is rounded, and read back it has to be the same plan.
  void snap(ScheduledPlan& plan) const {
    std::vector<double> before = plan.path.duration;
    if (!snap_runs(plan.path, task_.sample_period, plan.plan.delays)) return;
    ProgramPlan snapped = check_program(plan.path, filter_, task_.sample_period, machine_, plan.plan.delays);
    if (!all_holds(snapped)) {
      plan.path.duration = std::move(before);
      return;
    }
    plan.plan.alone.clear();  // they were for the durations before
    plan.plan.errors = std::move(snapped.errors);
    plan.plan.simulation = std::move(snapped.simulation);
    plan.plan.errors_hold = true;
  }
  /// Whether parts of a program show that it is clearly slower at the programmed feeds.
  bool slower_in_parts(const Toolpath& path) const {
    constexpr double clearly = 1.002;
    double kept = 0.0, chosen = 0.0;
    for (Toolpath& part : stretches(path, parts_max)) {
      chosen += seconds_of(
          schedule_feeds(part, filter_, task_.sample_period, machine_, feed_rounds_max, deadline_, feed_step_).plan,
          task_.sample_period);
      limit_rapids(part, filter_, task_.sample_period, machine_);
      const ProgramPlan plan = plan_program(part, filter_, task_.sample_period, machine_, false, deadline_);
      if (!all_holds(plan)) return true;
      kept += seconds_of(plan, task_.sample_period);
    }
    return kept > clearly * chosen;
  }
  /// Samples at the programmed feeds with no more than the delays that corners and stops need alone: plans take longer.
  std::int64_t least_kept(Toolpath path) const {
    ready_feeds(path, filter_, task_.sample_period, machine_);
    std::vector<int> delays = pairwise_delays(path, filter_, task_.sample_period, machine_).delays;
    delays = with_least_stops(path, std::move(delays), exact_stop_delay(filter_));
    for (std::size_t b = 0; b < path.blocks(); ++b) {
      if (!ends_leg(path, b)) delays[b] = 0;  // curves may be slowed instead
    }
    return motion_samples(CommandTiming(path, task_.sample_period, delays), filter_);
  }
  /// Stops were planned with the delay that legs longer than the filter need. After shorter legs the least may be
  /// enough.
  void relax_stops(ScheduledPlan& plan) const {
    if (!plan.path.given_delays.empty()) return;
    std::vector<int> delays = with_least_stops(plan.path, plan.plan.delays, exact_stop_delay(filter_));
    if (delays == plan.plan.delays) return;
    ProgramPlan relaxed = check_program(plan.path, filter_, task_.sample_period, machine_, std::move(delays));
    if (!all_holds(relaxed)) return;
    plan.plan.delays = std::move(relaxed.delays);
    plan.plan.errors = std::move(relaxed.errors);
    plan.plan.simulation = std::move(relaxed.simulation);
    plan.plan.errors_hold = true;
  }
  /// Simulates a plan whose feeds or delays were changed.
  void check(ScheduledPlan& plan) const {
    plan.plan = check_program(plan.path, filter_, task_.sample_period, machine_, std::move(plan.plan.delays));
    settle(plan);
  }
  /// Whether all moves together leave the modes of axes with no more than their bounds.
  bool quieten(ScheduledPlan& plan) const {
    const auto again = [this](ScheduledPlan& changed) { check(changed); };
    return accdec::quieten(plan, filter_, task_.sample_period, machine_, again, deadline_);
  }
  /// Delays as the control can give them, and whether it can.
  void settle(ScheduledPlan& plan) const {
    settle_delays(plan.path, filter_, task_.sample_period, machine_, plan.plan);
    if (!corner_feeds_had(plan.path, programmed_, plan.plan.delays, feed_step_)) plan.plan.delays_had = false;
  }
  void offer(ScheduledPlan plan, bool feeds_chosen) {
    relax_stops(plan);
    settle(plan);
    const bool first = best_.plan.delays.empty();
    const bool slow = plan.plan.simulation.samples >= best_.plan.simulation.samples;
    const bool quiet = (!first && quiet_ && slow) || quieten(plan);
    // If arcs are to be widened, a plan that widens them is better than a faster one that does not.
    const bool widened = !plan.path.programmed.empty(), had_widened = !best_.path.programmed.empty();
    const bool faster = plan.plan.simulation.samples < best_.plan.simulation.samples;
    const bool better = quiet != quiet_ ? quiet : widened == had_widened ? faster : widened;
    const bool beside = has_ratings(machine_) && programmed_.blocks() <= several_plans_max;
    if (!first && !(all_holds(plan.plan) && (!all_holds(best_.plan) || better))) {
      if (beside && quiet && all_holds(plan.plan)) beside_.emplace_back(std::move(plan), feeds_chosen);
      return;
    }
    if (beside && !first && quiet_ && all_holds(best_.plan))
      beside_.emplace_back(std::move(best_), result_.feeds_chosen);
    best_ = std::move(plan);
    quiet_ = quiet;
    result_.feeds_chosen = feeds_chosen;
  }

  ProgramResult& result_;
  const Toolpath& programmed_;
  double feed_step_;  // see corner_feed_step_of
  const Filter& set_;
  const Filter filter_;  // all that acts on the command
  const FilterBehind behind_;
  const Task& task_;
  const Machine& machine_;
  const Deadline& deadline_;
  ScheduledPlan best_;
  std::vector<std::pair<ScheduledPlan, bool>> beside_;  // other plans that hold, if drives have ratings; feeds chosen
  Toolpath base_;                                       // planned at the programmed feeds
  std::optional<double> kept_;                          // s, of that plan, which need not hold
  bool chosen_ = false;                                 // a plan of chosen feeds was found
  bool quiet_ = false;                                  // the best plan is, see quieten
  bool delays_had_ = true;
  std::vector<int> alone_;
};

}  // namespace

ProgramResult run_program(PlanningProblem problem, const Filter& filter, const KnownPlan& known) {
  const Task& task = problem.task;
  Toolpath& path = problem.path;
  const Feeds feeds = problem.feeds;
  const auto start = std::chrono::steady_clock::now();
  ProgramResult result = before_planning(problem);
  const Machine machine = program_machine(task.machine, path);
  require_fixed(task, machine, problem.filter_bound);
  // Computed before any move is slowed for this filter, because the bounds hold for all filters.
  snap_durations(path, Response(task.machine, task.sample_period).command(filter), task.sample_period, machine);
  result.lower_bound = program_lower_bound(path, machine, task.sample_period);
  if (problem.filter_bound) result.filter_bound = filter_lower_bound(path, machine, task.sample_period);
  Planning planning(result, path, filter, task, machine, problem.deadline);
  const bool written = planning.as_written(path, feeds);
  const bool keep = feeds == Feeds::keep || (feeds != Feeds::choose_only && path.blocks() <= several_plans_max);
  if (keep && !written) planning.keep(path, feeds == Feeds::keep);
  if (feeds != Feeds::keep && !written) planning.choose(path);
  if (feeds != Feeds::keep && keep && !written) planning.tune(path, feeds);
  if (!keep && feeds != Feeds::choose_only && !written) planning.compare_kept(path);
  planning.as_known(path, known);
  planning.stop(path, feeds != Feeds::keep);
  planning.cool();
  path = {};
  planning.take();
  result.cycle_time = static_cast<double>(result.check.samples) * task.sample_period;
  planning.other_rules();
  judge_program(result, machine, planning.alone());
  if (!planning.delays_had()) {
    result.verification.feasible = false;
    result.status = Status::failed;
    result.message = "the control has no delays with which a plan holds all limits" +
                     stop_that_breaks(result, exact_stop_delay(result.plan.filter()));
  }
  say_what_ended(result, problem.deadline);
  result.solver.method = "given";
  result.solver.wall_time = seconds_since(start);
  return result;
}

}  // namespace accdec
