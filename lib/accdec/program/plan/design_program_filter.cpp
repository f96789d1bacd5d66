#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include <accdec/design/baselines.hpp>
#include <accdec/design/design.hpp>
#include <accdec/files/seconds_since.hpp>
#include <accdec/motion/shapes.hpp>
#include <accdec/program/plan/design_program_filter.hpp>
#include <accdec/program/plan/filter_search.hpp>
#include <accdec/program/plan/plan_time.hpp>
#include <accdec/program/plan/program_plan.hpp>
#include <accdec/program/plan/representative_task.hpp>
#include <accdec/task/verifier.hpp>

namespace accdec {
namespace {

/// Unlimited when the filter cannot hold the limits.
double program_time(const Toolpath& path, const Filter& filter, const Task& task, const Machine& machine) {
  for (const LimitUse& use : vibration_utilisation(filter, task.sample_period, machine)) {
    if (use.utilisation > 1.0) return unlimited;
  }
  Toolpath copy = path;
  limit_rapids(copy, filter, task.sample_period, machine);
  snap_durations(copy, filter, task.sample_period, machine);
  const PairwiseDelays delays = pairwise_delays(copy, filter, task.sample_period, machine);
  if (!delays.limits_possible) return unlimited;
  const CommandTiming timing(copy, task.sample_period, delays.delays);
  return static_cast<double>(timing.command_samples() + filter.order() + 1) * task.sample_period;
}

/// With everything that overlaps: the time of the simulated plan. Unlimited when that does not hold.
double planned_time(const Toolpath& path, const Filter& filter, const Task& task, const Machine& machine) {
  Toolpath copy = path;
  limit_rapids(copy, filter, task.sample_period, machine);
  snap_durations(copy, filter, task.sample_period, machine);
  const ProgramPlan plan = plan_program(copy, filter, task.sample_period, machine);
  for (const LimitUse& use : plan.simulation.limits) {
    if (use.utilisation > 1.0 + verification_tolerance) return unlimited;
  }
  return plan.errors_hold ? static_cast<double>(plan.simulation.samples) * task.sample_period : unlimited;
}

class Deadline {
 public:
  explicit Deadline(double seconds) : seconds_(seconds) {}
  double left() const { return seconds_ - seconds_since(start_); }
  bool over() const { return left() < 0.0; }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  double seconds_;
};

/// Trapezoids judged by the whole program, which knows what a few corners do not: rapid moves, for instance, go faster
/// with longer filters. A coarse grid of orders and ramps, then steps around the best that halve. At most `evaluations`
/// programs are timed.
class TrapezoidSearch {
 public:
  /// @param time_limit  s
  TrapezoidSearch(const Toolpath& path, const Task& task, const Machine& machine, long evaluations, double time_limit)
      : path_(path), task_(task), machine_(machine), left_(evaluations), watch_(time_limit) {}

  void run() {
    const int low = task_.design.order_min, high = task_.design.order_max;
    for (double order = std::max(1, low); order <= high; order = std::max(order + 1.0, order * 1.3)) {
      for (const double part : {0.0, 0.25, 0.5}) offer(static_cast<int>(order), static_cast<int>(part * order));
    }
    for (int step = std::max(1, order_ / 8); filter_ && left_ > 0;) {
      const double before = time_;
      const int order = order_, ramp = ramp_;
      for (const int d : {-step, step}) {
        offer(order + d, ramp);
        offer(order, ramp + d);
        offer(order + d, ramp + d);
      }
      if (time_ < before) continue;
      if (step == 1) break;
      step /= 2;
    }
  }
  const std::optional<Filter>& filter() const { return filter_; }
  long evaluations() const { return used_; }

 private:
  void offer(int order, int ramp) {
    if (filter_ && watch_.over()) left_ = 0;
    if (left_ <= 0 || order < task_.design.order_min || order > task_.design.order_max || ramp < 0 || ramp > order / 2)
      return;
    --left_;
    ++used_;
    const Filter filter = trapezoid(order, ramp);
    const double time = program_time(path_, filter, task_, machine_);
    if (!(time < time_)) return;
    time_ = time;
    order_ = order;
    ramp_ = ramp;
    filter_ = filter;
  }

  const Toolpath& path_;
  const Task& task_;
  const Machine& machine_;
  long left_, used_ = 0;
  const Deadline watch_;
  std::optional<Filter> filter_;
  double time_ = unlimited;
  int order_ = 0, ramp_ = 0;
};

/// Filters for a program: their times are predicted, with exact delays of every corner but none of the overlaps between
/// corners, and the most promising ones are planned and simulated.
class Candidates {
 public:
  Candidates(const Toolpath& path, const Task& task, const Machine& machine,
             const std::function<void(const std::string&)>& progress)
      : path_(path), task_(task), machine_(machine), progress_(progress) {}

  void offer(const DesignResult& design, const std::string& name) {
    evaluations_ += design.solver.evaluations;
    if (!design.filter) {
      if (reason_.empty()) reason_ = design.message;
      return;
    }
    const double time = program_time(path_, *design.filter, task_, machine_);
    tell(fmt::format("{}: {} taps, {:.4f} s", name, design.filter->order() + 1, time));
    if (time < unlimited) all_.push_back({time, name, design});
  }

  /// Of the fastest prediction.
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
    // Of long programs fewer: a plan takes about as long as ten predictions.
    const long simulated = std::clamp(100'000L / static_cast<long>(path_.blocks()), 3L, 8L);
    for (std::size_t i = 0; i < all_.size() && static_cast<long>(i) < simulated; ++i) {
      const Candidate& c = all_[i];
      if (c.predicted >= shortest) break;  // a plan is not faster than its prediction
      simulate(*c.design.filter, c, best, shortest);
      // Where moves overlap, what each alone holds may not hold together, and repair costs time that a gentler filter
      // saves.
      for (double factor = 1.2; i == 0 && shortest > 1.005 * c.predicted && factor < 4.0; factor *= 1.2) {
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
      // Nothing planned holds; whoever plans the best prediction says which limit it breaks.
      take(*all_.front().design.filter, all_.front(), best);
    }
    return best;
  }

 private:
  struct Candidate {
    double predicted;
    std::string name;
    DesignResult design;
  };
  void tell(const std::string& line) const {
    if (progress_) progress_(line);
  }
  static void take(const Filter& filter, const Candidate& c, ProgramFilter& best) {
    best.filter = filter;
    best.solver.name = c.name;
    best.solver.version = c.design.solver.version;
    best.solver.claimed = c.design.solver.claimed;
  }
  void simulate(const Filter& filter, const Candidate& c, ProgramFilter& best, double& shortest) const {
    const double time = planned_time(path_, filter, task_, machine_);
    tell(fmt::format("{}: {} taps, {:.4f} s simulated", c.name, filter.order() + 1, time));
    if (!(time < shortest)) return;
    shortest = time;
    take(filter, c, best);
  }

  const Toolpath& path_;
  const Task& task_;
  const Machine& machine_;
  const std::function<void(const std::string&)>& progress_;
  std::vector<Candidate> all_;
  std::string reason_;
  long evaluations_ = 0;
};

}  // namespace

namespace {

/// Designs for the representative task: first no longer than the best shape, which is a fraction of the work where many
/// corners make the cost of a long filter small, then of any order, and of orders beside the best.
/// @param time_limit  s, of the whole search for a filter
void offer_designs(const Task& representative, Candidates& candidates, double time_limit) {
  Task shorter = representative;
  if (const auto order = candidates.best_order())
    shorter.design.order_max = std::clamp(*order, representative.design.order_min, representative.design.order_max);
  DesignOptions options;
  options.time_limit = 0.3 * time_limit;
  options.certificate = false;
  const auto offer = [&](const Task& task, const std::string& order) {
    DesignResult design = design_task(task, options);
    candidates.offer(design, (design.solver.name.empty() ? design.solver.method : design.solver.name) + order);
    return design;
  };
  offer(shorter, "");
  if (shorter.design.order_max < representative.design.order_max) offer(representative, " of any order");
  const auto order = candidates.best_order();
  if (!order) return;
  // What the classes leave out (rapid moves, blocks shorter than the filter) may want another order than theirs.
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
                                    const std::function<void(const std::string&)>& progress) {
  const auto start = std::chrono::steady_clock::now();
  const Task representative = representative_task(path, task);
  const Machine machine = program_machine(task.machine, path);
  Candidates candidates(path, task, machine, progress);
  // About as much work as reading a program of 50 million blocks.
  TrapezoidSearch search(path, task, machine, std::clamp(50'000'000L / static_cast<long>(path.blocks()), 40L, 2000L),
                         0.2 * time_limit);
  search.run();
  DesignResult found;
  found.filter = search.filter();
  found.message = "no trapezoid holds them";
  found.solver.evaluations = search.evaluations();
  candidates.offer(found, "trapezoid for the program");
  const Deadline families(0.3 * time_limit);
  // Those of few members first: whatever the time is left for is among the others.
  for (const bool large : {false, true}) {
    for (const Baseline& family : baselines()) {
      // Under a jerk limit these are searched for minutes, which a small program is not worth.
      const bool slow =
          family.shape == Shape::exponential || family.shape == Shape::gaussian || family.shape == Shape::blackman_sinc;
      if (large != (family.pairs > 0 || family.shape == Shape::averages || slow)) continue;
      if (families.over() || (slow && time_limit < 30.0)) continue;
      candidates.offer(best_baseline(representative, family, families.left()).result, std::string(family.name));
    }
  }
  offer_designs(representative, candidates, time_limit);
  ProgramFilter best = candidates.fastest();
  best.solver.method = "representative corners";
  best.solver.wall_time = seconds_since(start);
  return best;
}

ProgramFilter design_filter_for_feeds(const Toolpath& path, const Task& task, double time_limit,
                                      const std::function<void(const std::string&)>& progress) {
  const auto start = std::chrono::steady_clock::now();
  const Machine machine = program_machine(task.machine, path);
  FilterSearchOptions options;
  options.order_min = std::max(0, task.design.order_min);
  options.order_max = task.design.order_max;
  options.time_limit = time_limit;
  options.progress = progress;
  const FilterSearch search = search_filter(path, task.sample_period, machine, options);
  const bool loads = std::any_of(machine.axes.begin(), machine.axes.end(), [](const Axis& axis) {
    return axis.force_max < unlimited || axis.power_max < unlimited || axis.regeneration_max < unlimited;
  });
  ProgramFilter best;
  if (!search.filter || loads || !machine.modes.empty()) {
    best = design_program_filter(path, task, time_limit, progress);
    if (!best.filter) best.message = best.message.empty() ? "no filter holds the limits" : best.message;
  }
  // As the planner has it: feeds chosen or, of programs that are not too long for both plans, as programmed.
  const auto time = [&](const Filter& filter) {
    const ScheduledPlan plan = schedule_feeds(path, filter, task.sample_period, machine, 3);
    const double chosen =
        all_holds(plan.plan) ? static_cast<double>(plan.plan.simulation.samples) * task.sample_period : unlimited;
    // A plan at programmed feeds is not faster than its prediction, and takes many times as long to make.
    if (path.blocks() > several_plans_max || program_time(path, filter, task, machine) >= chosen) return chosen;
    return std::min(chosen, planned_time(path, filter, task, machine));
  };
  if (search.filter && (!best.filter || time(*search.filter) <= time(*best.filter))) {
    best.filter = search.filter;
    best.solver.name = "trapezoid";
    best.message.clear();
  }
  best.solver.method = "filter and feeds together";
  best.solver.evaluations += search.evaluations;
  best.solver.wall_time = seconds_since(start);
  return best;
}

}  // namespace accdec
