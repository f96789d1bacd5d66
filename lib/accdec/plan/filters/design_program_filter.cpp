#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include <accdec/design.hpp>
#include <accdec/families/trial_search.hpp>
#include <accdec/family.hpp>
#include <accdec/files.hpp>
#include <accdec/machine/limits.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/plan/command/program_plan.hpp>
#include <accdec/plan/command/stop_everywhere.hpp>
#include <accdec/plan/feeds/stretched.hpp>
#include <accdec/plan/filters/design_program_filter.hpp>
#include <accdec/plan/filters/filter_search.hpp>
#include <accdec/plan/filters/representative_task.hpp>
#include <accdec/program.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

/// Programs of at most so many blocks are cheap enough to judge a filter by the plan that will be made.
constexpr std::size_t short_program = 2'000;

/// Unlimited when the filter cannot hold the limits, or once the time is over.
/// @param set  without the control's own smoothing
double program_time(const Toolpath& path, const Filter& set, const Task& task, const Machine& machine,
                    const Deadline& until = {}) {
  const Filter filter = Response(task.machine, task.sample_period).command(set);
  for (const LimitUse& use : vibration_utilisation(filter, task.sample_period, machine)) {
    if (use.utilisation > 1.0) return unlimited;
  }
  Toolpath copy = path;
  ready_feeds(copy, filter, task.sample_period, machine);
  const PairwiseDelays delays = pairwise_delays(copy, filter, task.sample_period, machine, DelayRule::smallest, &until);
  if (!delays.limits_possible) return unlimited;
  const CommandTiming timing(copy, task.sample_period, delays.delays);
  return static_cast<double>(timing.command_samples() + filter.order() + 1) * task.sample_period;
}

/// The time of the simulated plan, with all overlaps. Unlimited if the plan does not hold.
/// @param known  gets a plan that holds
double planned_time(const Toolpath& path, const Filter& set, const Task& task, const Machine& machine,
                    const Deadline& deadline, KnownPlan* known = nullptr) {
  const Filter filter = Response(task.machine, task.sample_period).command(set);
  Toolpath copy = path;
  limit_rapids(copy, filter, task.sample_period, machine);
  snap_durations(copy, filter, task.sample_period, machine);
  ProgramPlan plan = plan_program(copy, filter, task.sample_period, machine, true, deadline);
  for (const LimitUse& use : plan.simulation.limits) {
    if (use.utilisation > 1.0 + verification_tolerance) return unlimited;
  }
  if (!plan.errors_hold) return unlimited;
  if (known != nullptr) *known = {std::move(copy.duration), std::move(plan.delays), plan.slowed};
  return static_cast<double>(plan.simulation.samples) * task.sample_period;
}

/// The time of the plan for want of another, s.
/// @param set  without the control's own smoothing
double stopping_time(const Toolpath& path, const Filter& set, const Task& task, const Machine& machine) {
  const Filter filter = Response(task.machine, task.sample_period).command(set);
  return stop_everywhere_samples(path, filter, task.sample_period, machine) * task.sample_period;
}

/// Two averages judged by the whole program, which knows what a few corners do not: rapid moves, for instance, go
/// faster with longer filters. A coarse grid of orders and second averages, then steps around the best.
/// @param evaluations  at most so many programs are timed
/// @param time_limit   s
/// @param end  of the search also if no two averages hold the limits so far
DesignResult two_averages_for(const Toolpath& path, const Task& task, const Machine& machine, long evaluations,
                              double time_limit, const Deadline& end) {
  const Deadline watch(time_limit);
  bool found = false;
  const auto time = [&](const Filter& filter) {
    --evaluations;
    const double seconds = program_time(path, filter, task, machine, end);
    found = found || seconds < unlimited;
    return seconds;
  };
  const int low = task.design.order_min, high = task.design.order_max;
  TrialSearch search(*find_family("trapezoid"), {low, high}, time,
                     [&] { return evaluations <= 0 || end.over() || (found && watch.over()); });
  for (double order = std::max(1, low); order <= high; order = std::max(order + 1.0, order * 1.3)) {
    for (const double part : {0.0, 0.25, 0.5}) {
      const int ramp = static_cast<int>(part * order);
      search.offer({static_cast<int>(order) - ramp + 1, ramp + 1});
    }
  }
  search.refine(8);
  DesignResult result;
  if (search.found()) result.filter = search.filter();
  result.message = "no two averages hold them";
  result.solver.evaluations = search.tried();
  return result;
}

/// Filters for a program. Their times are predicted with exact delays of every corner but without overlaps between
/// corners. The most promising ones are planned and simulated.
class Candidates {
 public:
  Candidates(const Toolpath& path, const Task& task, const Machine& machine,
             const std::function<void(const std::string&)>& progress, const Deadline& deadline)
      : path_(path), task_(task), machine_(machine), progress_(progress), deadline_(deadline) {}

  void offer(const DesignResult& design, const std::string& name) {
    evaluations_ += design.solver.evaluations;
    if (!design.filter) {
      if (reason_.empty()) reason_ = design.message;
      return;
    }
    const double time = program_time(path_, *design.filter, task_, machine_);
    tell(name, *design.filter, time, "predicted");
    if (time < unlimited) all_.push_back({time, name, design});
  }

  /// The order of the fastest prediction.
  std::optional<int> best_order() const {
    const auto best = std::min_element(all_.begin(), all_.end(),
                                       [](const auto& a, const auto& b) { return a.predicted < b.predicted; });
    return best == all_.end() ? std::nullopt : std::optional(best->design.filter->order());
  }

  /// The fastest plan that holds, not the fastest prediction.
  ProgramFilter fastest() {
    ProgramFilter best;
    std::stable_sort(all_.begin(), all_.end(), [](const auto& a, const auto& b) { return a.predicted < b.predicted; });
    double shortest = unlimited;
    // Fewer for long programs: a plan takes about as long as ten predictions.
    const long simulated = std::clamp(100'000L / static_cast<long>(path_.blocks()), 3L, 8L);
    for (std::size_t i = 0; i < all_.size() && static_cast<long>(i) < simulated; ++i) {
      const Candidate& c = all_[i];
      if (c.predicted >= shortest) break;  // a plan is not faster than its prediction
      if (i > 0 && deadline_.over()) break;
      simulate(*c.design.filter, c, best, shortest);
      // If moves overlap, limits that each move holds alone may break together. A gentler filter can save the time
      // that repair costs.
      for (double factor = 1.2; i == 0 && shortest > 1.005 * c.predicted && factor < 4.0 && !deadline_.over();
           factor *= 1.2) {
        const Filter gentler =
            stretched(*c.design.filter, static_cast<int>(std::ceil((c.design.filter->order() + 1) * factor)));
        if (gentler.order() > task_.design.order_max) break;
        if (program_time(path_, gentler, task_, machine_) >= shortest) break;
        simulate(gentler, c, best, shortest);
      }
    }
    best.solver.evaluations = evaluations_;
    if (best.filter) return best;
    if (all_.empty()) {
      best.message = "no filter within the task's bounds holds the limits: " + reason_;
    } else {
      // No plan holds: planning the best prediction then tells which limit it breaks. If only the time did not suffice,
      // a plan with stops is made, and the filter is the one that suits it.
      const auto stops = [&](const Candidate& c) { return stopping_time(path_, *c.design.filter, task_, machine_); };
      const auto& c = !deadline_.over() ? all_.front() : *std::ranges::min_element(all_, {}, stops);
      take(*c.design.filter, c, best);
    }
    return best;
  }

 private:
  struct Candidate {
    double predicted;
    std::string name;
    DesignResult design;
  };
  void tell(const std::string& name, const Filter& filter, double time, const char* how) const {
    if (!progress_) return;
    const int taps = filter.order() + 1;
    progress_(time < unlimited ? fmt::format("{}: {} taps, {:.4f} s {}", name, taps, time, how)
                               : fmt::format("{}: {} taps break a limit of the program", name, taps));
  }
  static void take(const Filter& filter, const Candidate& c, ProgramFilter& best) {
    best.filter = filter;
    best.solver.name = c.name;
    best.solver.version = c.design.solver.version;
    best.solver.claimed = c.design.solver.claimed;
  }
  void simulate(const Filter& filter, const Candidate& c, ProgramFilter& best, double& shortest) const {
    KnownPlan known;
    const double time = planned_time(path_, filter, task_, machine_, deadline_, &known);
    tell(c.name, filter, time, "simulated");
    if (!(time < shortest)) return;
    shortest = time;
    take(filter, c, best);
    best.plan = std::move(known);
  }

  const Toolpath& path_;
  const Task& task_;
  const Machine& machine_;
  const std::function<void(const std::string&)>& progress_;
  const Deadline& deadline_;
  std::vector<Candidate> all_;
  std::string reason_;
  long evaluations_ = 0;
};

}  // namespace

namespace {

/// Makes designs for the representative task. The first are not longer than the best shape: this is a fraction of the
/// work if many corners make a long filter cheap. Then come any order, and orders near the best.
/// @param time_limit  s, of the whole search for a filter
void offer_designs(const Task& representative, Candidates& candidates, double time_limit) {
  Task shorter = representative;
  if (const auto order = candidates.best_order())
    shorter.design.order_max = std::clamp(*order, representative.design.order_min, representative.design.order_max);
  DesignOptions options;
  options.time_limit = 0.3 * time_limit;
  options.exact.certificate = false;
  const auto offer = [&](const Task& task, const std::string& order) {
    DesignResult design = design_task(task, options);
    candidates.offer(design, (design.solver.name.empty() ? design.solver.method : design.solver.name) + order);
    return design;
  };
  offer(shorter, "");
  if (shorter.design.order_max < representative.design.order_max) offer(representative, " of any order");
  const auto order = candidates.best_order();
  if (!order) return;
  // Moves outside the classes (rapid moves, blocks shorter than the filter) may need another order.
  options.time_limit = 0.1 * time_limit;
  for (const int step : {-4, -2, 2, 4}) {
    Task other = representative;
    other.design.order_max = std::max(shorter.design.order_max, *order + step);
    (step < 0 ? other.design.order_max : other.design.order_min) = *order + step;
    if (*order + step >= representative.design.order_min && *order + step <= representative.design.order_max)
      offer(other, fmt::format(" of order {}", *order + step));
  }
}

}  // namespace

ProgramFilter design_program_filter(const Toolpath& path, const Task& task, double time_limit,
                                    const std::function<void(const std::string&)>& progress, const Deadline& deadline) {
  const auto start = std::chrono::steady_clock::now();
  const Task representative = representative_task(path, task);
  const Machine machine = program_machine(task.machine, path);
  Candidates candidates(path, task, machine, progress, deadline);
  // About as much work as reading a program of 50 million blocks.
  const long evaluations = std::clamp(50'000'000L / static_cast<long>(path.blocks()), 40L, 2000L);
  candidates.offer(two_averages_for(path, task, machine, evaluations, 0.2 * time_limit, Deadline(0.6 * time_limit)),
                   "two averages for the program");
  const Deadline of_families(0.3 * time_limit);
  // Those of few members first: whatever the time is left for is among the others.
  for (const bool large : {false, true}) {
    for (const Family& family : families()) {
      // Under a jerk limit these are searched for minutes, which a small program is not worth.
      const bool slow = family.parameter.has_value();
      if (large != (family.pairs > 0 || family.averages == 3 || slow)) continue;
      if (of_families.over() || (slow && time_limit < 30.0)) continue;
      candidates.offer(best_member(representative, family, of_families.left()).result, std::string(family.name));
    }
  }
  offer_designs(representative, candidates, time_limit);
  ProgramFilter best = candidates.fastest();
  best.solver.method = "representative corners";
  best.solver.wall_time = seconds_since(start);
  return best;
}

ProgramFilter design_filter_for_feeds(const Toolpath& path, const Task& task, double time_limit,
                                      const std::function<void(const std::string&)>& progress,
                                      const Deadline& deadline) {
  const auto start = std::chrono::steady_clock::now();
  const Machine machine = program_machine(task.machine, path);
  FilterSearchOptions options;
  options.order_min = std::max(0, task.design.order_min);
  options.order_max = task.design.order_max;
  options.time_limit = time_limit;
  options.progress = progress;
  options.smoothing = task.machine.prefilter_taps;
  const FilterSearch search = search_filter(path, task.sample_period, machine, options);
  // Without a limit on the acceleration, the programmed feed may be reached at once by a filter that suits it.
  const bool others = limits_supply(machine) || std::ranges::any_of(machine.axes, [](const Axis& axis) {
                        return limited_beside(axis, {LimitKind::velocity, LimitKind::acceleration, LimitKind::jerk}) ||
                               (!(axis.acceleration_max < unlimited) && axis.jerk_max < unlimited);
                      });
  ProgramFilter best;
  if (!search.filter || others || !machine.modes.empty() || path.contour_max < unlimited) {
    const double left = std::max(0.05, std::min(time_limit, 0.5 * deadline.left()));
    best = design_program_filter(path, task, left, progress, deadline);
    if (!best.filter) best.message = best.message.empty() ? "no filter holds the limits" : best.message;
  }
  // A plan that would hold after more rounds must not lose against one at the programmed feeds.
  const int rounds = path.blocks() <= short_program ? 40 : 3;
  // As in the planner: with chosen feeds or, for programs that are short enough for both plans, with programmed feeds.
  const auto time = [&](const Filter& filter) {
    if (deadline.over()) return stopping_time(path, filter, task, machine);
    const ScheduledPlan plan = schedule_feeds(path, Response(task.machine, task.sample_period).command(filter),
                                              task.sample_period, machine, rounds, deadline);
    const double chosen =
        all_holds(plan.plan) ? static_cast<double>(plan.plan.simulation.samples) * task.sample_period : unlimited;
    // A plan at programmed feeds is not faster than its prediction and takes many times as long to compute.
    if (path.blocks() > several_plans_max || program_time(path, filter, task, machine) >= chosen) return chosen;
    return std::min(chosen, planned_time(path, filter, task, machine, deadline));
  };
  // Without time to plan with it, a filter that knows neither modes of axes nor the contour is no choice. Nor is it
  // where the other has a plan that holds.
  const bool unsure =
      deadline.over() && (has_mode_of_axis(machine) || path.contour_max < unlimited || !best.plan.delays.empty());
  if (search.filter && (!best.filter || (!unsure && time(*search.filter) <= time(*best.filter)))) {
    best.filter = search.filter;
    best.plan = {};
    best.solver.name = "two averages";
    best.message.clear();
  }
  best.solver.method = "filter and feeds together";
  best.solver.evaluations += search.evaluations;
  best.solver.wall_time = seconds_since(start);
  return best;
}

}  // namespace accdec
