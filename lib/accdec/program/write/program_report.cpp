#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <optional>
#include <string_view>

#include <fmt/format.h>

#include <accdec/files/seconds_since.hpp>
#include <accdec/machine/limits.hpp>
#include <accdec/program/plan/choose_feeds.hpp>
#include <accdec/program/plan/choose_leg_filters.hpp>
#include <accdec/program/plan/filter_bound.hpp>
#include <accdec/program/plan/lower_bound.hpp>
#include <accdec/program/write/emitted_filters.hpp>
#include <accdec/program/write/program_report.hpp>
#include <accdec/task/verifier.hpp>

namespace accdec {
namespace {

/// Adds the worst use of every vibration bound by any of the filters.
void add_vibration(ProgramResult& result, const Machine& machine) {
  std::vector<LimitUse> worst_modes;
  for (const Filter& filter : result.legs.filters()) {
    const std::vector<LimitUse> modes = vibration_utilisation(filter, result.sample_period, machine);
    if (worst_modes.empty()) worst_modes = modes;
    for (std::size_t i = 0; i < modes.size(); ++i) {
      if (modes[i].utilisation > worst_modes[i].utilisation) worst_modes[i] = modes[i];
    }
  }
  for (const LimitUse& use : worst_modes) {
    result.plan.simulation.limits.push_back(use);
    result.plan.simulation.limit_lines.push_back(0);
  }
}

void judge_limits(ProgramResult& result) {
  const std::vector<LimitUse>& limits = result.plan.simulation.limits;
  VerificationReport& report = result.verification;
  report.performed = true;
  report.tolerance = verification_tolerance;
  double worst = 0.0;
  for (const LimitUse& use : limits) {
    if (use.utilisation <= worst) continue;
    worst = use.utilisation;
    report.worst = use.kind == LimitKind::vibration
                       ? fmt::format("vibration: {:.1f} % at {:.6g} Hz", 100.0 * use.utilisation, use.frequency)
                       : fmt::format("{} {}: {:.1f} % at sample {}, {}", to_string(use.kind), use.axis,
                                     100.0 * use.utilisation, use.sample, use.corner);
  }
  if (result.worst_utilisation > worst) {
    worst = result.worst_utilisation;
    report.worst = fmt::format("corner error: {:.1f} % of its tolerance, line {}", 100.0 * worst, result.worst_line);
  }
  report.max_violation = std::max(0.0, worst - 1.0);
  const bool limits_hold = std::all_of(limits.begin(), limits.end(), [](const LimitUse& use) {
    return use.utilisation <= 1.0 + verification_tolerance;
  });
  report.feasible = result.plan.errors_hold && limits_hold;
  result.status = report.feasible ? Status::feasible : Status::failed;
  if (!report.feasible) result.message = "a limit is broken: " + report.worst;
}

void count_joints(ProgramResult& result) {
  const Toolpath& path = result.path;
  for (std::size_t b = 0; b + 1 < path.blocks(); ++b) {
    const int delay = result.plan.delays[b];
    result.delay_total += delay * result.sample_period;
    if (path.joint[b] == Joint::straight && delay == 0) continue;
    ++result.corners;
    if (delay > 0) ++result.delayed;
    const int stop_delay =
        std::max(1, result.legs.of(b).last_nonzero_tap() - result.legs.of(b + 1).first_nonzero_tap());
    if (path.joint[b] == Joint::stop || delay >= stop_delay) ++result.exact_stops;
    if (!(path.tolerance[b] < unlimited)) continue;
    const double error = result.plan.errors[b] <= position_floor ? 0.0 : result.plan.errors[b];
    result.worst_error = std::max(result.worst_error, error);
    const double use = utilisation_of(LimitKind::corner_error, error, path.tolerance[b]);
    if (use > result.worst_utilisation || result.worst_line == 0) {
      result.worst_utilisation = use;
      result.worst_line = path.line[b];
    }
  }
}

}  // namespace

void judge_program(ProgramResult& result, const Machine& machine) {
  count_joints(result);
  result.raised = raised_delays(result.path, result.legs, result.sample_period, machine, result.plan.delays);
  add_vibration(result, machine);
  judge_limits(result);
}

namespace {

/// Only programs this short are planned with every curve tried at several feeds, and those at programmed feeds only
/// where they are not this many times slower than with chosen ones: it takes ten times as long and saves a few percent.
constexpr std::size_t tuned_max = 2'000;
constexpr double hopelessly_slower = 1.25;

/// Makes the plan of the result: the fastest of those asked for that hold.
class Planning {
 public:
  Planning(ProgramResult& result, const Task& task, const Machine& machine)
      : result_(result), task_(task), machine_(machine) {}

  /// At the programmed feeds, rapid moves as fast as the filter starts and stops them.
  /// @param tune_curves  see plan_program
  void keep(const Toolpath& path, bool tune_curves) {
    tune_curves_ = tune_curves;
    if (!path.given.empty()) as_commanded(path, result_.filter, false);
    slowed_ = path;
    limit_rapids(slowed_, result_.filter, task_.sample_period, machine_);
    snap_durations(slowed_, result_.filter, task_.sample_period, machine_);
    base_ = slowed_;
    ProgramPlan plan = plan_program(base_, result_.filter, task_.sample_period, machine_, tune_curves);
    result_.cycle_time_one_filter = seconds(plan);
    result_.cycle_time_kept = seconds(plan);
    offer({base_, std::move(plan)}, result_.filter, false);
  }
  void choose(const Toolpath& path) {
    if (path.blocks() <= several_plans_max || !path.given.empty()) as_commanded(path, result_.filter, true);
    ScheduledPlan plan = schedule_feeds(path, result_.filter, task_.sample_period, machine_);
    if (!result_.cycle_time_kept && !all_holds(plan.plan) && !all_holds(result_.plan)) keep(path, false);
    offer(std::move(plan), result_.filter, true);
    result_.cycle_time_one_filter = seconds(result_.plan);
  }
  /// Once more at the programmed feeds, beside chosen ones.
  void tune(const Toolpath& path) {
    if (!result_.cycle_time_kept || *result_.cycle_time_kept > hopelessly_slower * seconds(result_.plan)) return;
    keep(path, true);
    result_.cycle_time_one_filter = seconds(result_.plan);
  }
  /// At the programmed feeds, and at those that the plan of one filter chose.
  /// @param path  as read: what was written for a filter a leg names them
  void per_leg(const Toolpath& path, Feeds feeds) {
    if (auto legs = emitted_legs(path, result_.filter)) as_commanded(path, std::move(*legs), feeds != Feeds::keep);
    if (result_.feeds_chosen && result_.programmed_blocks <= several_plans_max) per_leg(result_.path, true);
    if (slowed_.blocks() > 0) per_leg(std::move(slowed_), false);
  }

  /// The time of another rule of delays at the programmed feeds, or with those of the plan where it alone was made.
  double by_rule(DelayRule rule) const {
    const Toolpath& path = result_.feeds_chosen && result_.cycle_time_kept ? base_ : result_.path;
    const std::vector<int> delays = pairwise_delays(path, result_.legs, task_.sample_period, machine_, rule).delays;
    return static_cast<double>(motion_samples(CommandTiming(path, task_.sample_period, delays), result_.legs)) *
           task_.sample_period;
  }

  /// With the legs at rest between, which takes a sample more than delays that let the last tap of one and the first
  /// of the next act together, where these break a limit. Simulated; what is broken nevertheless is named.
  void exact_stops() {
    const Toolpath& path = result_.feeds_chosen && result_.cycle_time_kept ? base_ : result_.path;
    std::vector<int> delays =
        pairwise_delays(path, result_.legs, task_.sample_period, machine_, DelayRule::exact_stop).delays;
    for (const int more : {0, 1}) {
      for (int& delay : delays) delay += delay > 0 ? more : 0;
      const ProgramPlan plan = check_program(path, result_.legs, task_.sample_period, machine_, delays);
      result_.cycle_time_exact_stop = seconds(plan);
      double worst = 1.0 + verification_tolerance;
      result_.exact_stop_breaks.clear();
      for (const LimitUse& use : plan.simulation.limits) {
        if (use.utilisation <= worst) continue;
        worst = use.utilisation;
        result_.exact_stop_breaks = fmt::format("{} {}", to_string(use.kind), use.axis);
      }
      if (result_.exact_stop_breaks.empty()) return;
    }
  }

 private:
  /// With the feeds and delays of the program, unchanged: what a plan wrote holds as it is.
  void as_commanded(const Toolpath& path, LegFilters legs, bool feeds_chosen) {
    ScheduledPlan plan{path, {}};
    if (!feeds_chosen) limit_rapids(plan.path, result_.filter, task_.sample_period, machine_);
    snap_legs(plan.path, task_.sample_period);
    std::vector<int> delays(path.blocks(), 0);
    for (std::size_t b = 0; b + 1 < path.blocks(); ++b) {
      if (path.joint[b] == Joint::stop)
        delays[b] = std::max(0, legs.of(b).last_nonzero_tap() - legs.of(b + 1).first_nonzero_tap());
    }
    for (const auto& [block, delay] : path.given) {
      delays[block] = static_cast<int>(std::lround(std::min(delay / task_.sample_period, 1e9)));
    }
    plan.plan = check_program(plan.path, legs, task_.sample_period, machine_, std::move(delays));
    if (all_holds(plan.plan)) offer(std::move(plan), std::move(legs), feeds_chosen);
  }
  void per_leg(Toolpath path, bool feeds_chosen) {
    LegFilters legs = choose_leg_filters(path, result_.filter, task_.sample_period, machine_, task_.design.order_max);
    ProgramPlan plan = plan_program(path, legs, task_.sample_period, machine_, !feeds_chosen && tune_curves_);
    offer({std::move(path), std::move(plan)}, std::move(legs), feeds_chosen);
  }
  double seconds(const ProgramPlan& plan) const {
    return static_cast<double>(plan.simulation.samples) * task_.sample_period;
  }
  void offer(ScheduledPlan plan, LegFilters legs, bool feeds_chosen) {
    const bool first = result_.plan.delays.empty();
    // Where arcs were to be widened, a plan that does is better than a faster one that does not.
    const bool widened = !plan.path.programmed.empty(), had_widened = !result_.path.programmed.empty();
    const bool faster = plan.plan.simulation.samples < result_.plan.simulation.samples;
    const bool better =
        all_holds(plan.plan) && (!all_holds(result_.plan) || (widened == had_widened ? faster : widened));
    if (!first && !better) return;
    result_.path = std::move(plan.path);
    result_.plan = std::move(plan.plan);
    result_.legs = std::move(legs);
    result_.feeds_chosen = feeds_chosen;
  }

  ProgramResult& result_;
  const Task& task_;
  const Machine& machine_;
  Toolpath slowed_, base_;  // with rapid moves slowed; and planned at these feeds
  bool tune_curves_ = true;
};

}  // namespace

ProgramResult run_program(const std::string& name, Toolpath path, const Filter& filter, const Task& task, bool per_leg,
                          bool filter_bound, Feeds feeds) {
  const auto start = std::chrono::steady_clock::now();
  ProgramResult result;
  result.program = name;
  result.filter = filter;
  result.legs = LegFilters(filter);
  result.sample_period = task.sample_period;
  result.task_machine = task.machine;
  result.programmed_blocks = path.blocks();
  const Machine machine = program_machine(task.machine, path);
  // Before any move is slowed to suit this filter: the bounds are for all.
  snap_durations(path, filter, task.sample_period, machine);
  result.lower_bound = program_lower_bound(path, machine, task.sample_period);
  if (filter_bound) result.filter_bound = filter_lower_bound(path, machine, task.sample_period);
  const Toolpath read = per_leg ? path : Toolpath{};
  Planning planning(result, task, machine);
  const bool keep = feeds == Feeds::keep || (feeds == Feeds::choose && (per_leg || path.blocks() <= several_plans_max));
  if (keep) planning.keep(path, feeds == Feeds::keep);
  if (feeds != Feeds::keep) planning.choose(path);
  if (feeds != Feeds::keep && keep && path.blocks() <= tuned_max) planning.tune(path);
  if (per_leg) planning.per_leg(read, feeds);
  result.cycle_time = static_cast<double>(result.plan.simulation.samples) * task.sample_period;
  path = {};
  // For the plan it was enough that each joint holds; what is reported is the least distance.
  SimulationOptions whole;
  whole.whole_windows = true;
  simulate_program(CommandTiming(result.path, task.sample_period, result.plan.delays), result.legs, 0,
                   result.path.blocks() - 1, result.plan.errors, whole);
  result.cycle_time_no_delay = planning.by_rule(DelayRule::none);
  planning.exact_stops();
  judge_program(result, machine);
  result.solver.method = "given";
  result.solver.wall_time = seconds_since(start);
  return result;
}

double widest(const Toolpath& path) {
  double most = 0.0;
  const std::size_t n = path.dimensions();
  for (std::size_t i = 0; i <= path.blocks() && !path.programmed.empty(); ++i) {
    double sum = 0.0;
    for (std::size_t a = 0; a < n; ++a)
      sum += (path.point(i)[a] - path.asked(i)[a]) * (path.point(i)[a] - path.asked(i)[a]);
    most = std::max(most, std::sqrt(sum));
  }
  return most;
}

std::vector<CornerUse> worst_corners(const ProgramResult& result, std::size_t count) {
  // Sorted, never more than `count`: programs have many joints, few of which are among the worst.
  std::vector<CornerUse> worst;
  const auto offer = [&](const CornerUse& corner) {
    if (worst.size() == count && corner.utilisation <= worst.back().utilisation) return;
    if (worst.size() == count) worst.pop_back();
    const auto after = std::upper_bound(worst.begin(), worst.end(), corner.utilisation,
                                        [](double use, const CornerUse& other) { return use > other.utilisation; });
    worst.insert(after, corner);
  };
  std::optional<CornerUse> of_line;
  const Toolpath& path = result.path;
  for (std::size_t b = 0; b + 1 < path.blocks() && count > 0; ++b) {
    if (!(path.tolerance[b] < unlimited)) continue;
    const double error = result.plan.errors[b] <= position_floor ? 0.0 : result.plan.errors[b];
    const double use = utilisation_of(LimitKind::corner_error, error, path.tolerance[b]);
    const CornerUse corner{path.line[b], error, path.tolerance[b], use, result.plan.delays[b]};
    if (of_line && of_line->line != corner.line) offer(*of_line);
    if (!of_line || of_line->line != corner.line || use > of_line->utilisation) of_line = corner;
  }
  if (of_line) offer(*of_line);
  return worst;
}

std::string delays_to_csv(const ProgramResult& result) {
  fmt::memory_buffer text;
  const auto put = std::back_inserter(text);
  fmt::format_to(put, "line,delay_samples,corner_error_m,error_max_m\n");
  const Toolpath& path = result.path;
  for (std::size_t b = 0; b + 1 < path.blocks(); ++b) {
    if (path.joint[b] == Joint::straight && result.plan.delays[b] == 0) continue;
    const double error = result.plan.errors[b] <= position_floor ? 0.0 : result.plan.errors[b];
    fmt::format_to(put, "{},{},{:.9g},", path.line[b], result.plan.delays[b], error);
    if (path.tolerance[b] < unlimited) fmt::format_to(put, "{:.9g}", path.tolerance[b]);
    fmt::format_to(put, "\n");
  }
  return fmt::to_string(text);
}

}  // namespace accdec
