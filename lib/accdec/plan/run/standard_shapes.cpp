#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>

#include <accdec/families/trial_search.hpp>
#include <accdec/family.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/plan/command/choose_feeds.hpp>
#include <accdec/plan/report/axis_loads.hpp>
#include <accdec/plan/run/cool_drives.hpp>
#include <accdec/plan/run/standard_shapes.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

/// Work, in samples simulated for plans. A sample takes about 1e-7 s, and behind servos with a contour three times
/// that.
constexpr double work_max = 1e8;
constexpr double cooling_trials = 40.0;  // plans simulated while one shape is cooled
constexpr double first_length = 0.03;    // s, of the first Hann filter
constexpr double coarse = 1.5;           // from each length to the next
constexpr int losses_max = 3;            // in a row, before longer or shorter ones are left out
constexpr int mending_rounds = 40;       // of mending chosen feeds
constexpr int breaks_max = 3;            // plans of chosen feeds that do not hold, before none is made any more

class Shapes {
 public:
  Shapes(const Toolpath& path, const Task& task, bool keep, const Deadline& deadline,
         const std::function<void(const std::string&)>& tell)
      : path_(path),
        task_(task),
        machine_(program_machine(task.machine, path)),
        keep_(keep),
        deadline_(deadline),
        tell_(tell),
        averages_(
            *find_family("trapezoid"), {task.design.order_min, task.design.order_max},
            [this](const Filter& filter) { return time_of(filter, "two averages"); }, [this] { return over(); }) {}

  ProgramFilter run() {
    const auto start = std::chrono::steady_clock::now();
    scan_hann();
    offer_averages();
    for (double step = std::sqrt(coarse); hann_ > 0 && !over(); step = std::sqrt(step)) {
      const int at = hann_, longer = static_cast<int>(std::lround(at * step));
      if (longer == at) break;
      try_hann(longer);
      try_hann(static_cast<int>(std::lround(at / step)));
    }
    averages_.refine(6);
    ProgramFilter found;
    const bool averages = averages_.found() && averages_.cost() < time_of_hann();
    if (averages || hann_ > 0) {
      found.filter = averages ? averages_.filter() : make_filter({Shape::hann, hann_});
      found.solver.name = averages ? "two averages" : "hann";
      found.designed = true;
    }
    found.solver.method = "standard shapes";
    found.solver.evaluations = averages_.tried() + static_cast<long>(times_.size());
    found.solver.wall_time = seconds_since(start);
    return found;
  }

 private:
  bool over() const { return work_ > work_max || deadline_.over(); }
  double time_of_hann() const { return hann_ > 0 ? times_.at(hann_) : unlimited; }

  /// @return whether it is the best Hann filter so far
  bool try_hann(int order) {
    if (order < std::max(2, task_.design.order_min) || order > task_.design.order_max) return false;
    if (times_.contains(order) || over()) return false;
    const double time = times_[order] = time_of(make_filter({Shape::hann, order}), "hann");
    if (!(time < time_of_hann())) return false;
    hann_ = order;
    return true;
  }

  void scan_hann() {
    const double first = std::clamp(first_length / task_.sample_period, std::max(2.0, 1.0 * task_.design.order_min),
                                    std::max(2.0, 1.0 * task_.design.order_max));
    try_hann(static_cast<int>(first));
    int losses[2] = {0, 0};
    for (double factor = coarse; (losses[0] < losses_max || losses[1] < losses_max) && !over(); factor *= coarse) {
      const double orders[2] = {first * factor, first / factor};
      if (orders[0] > task_.design.order_max && orders[1] < 2.0) break;
      for (int i = 0; i < 2; ++i) {
        if (losses[i] >= losses_max || orders[i] > task_.design.order_max) continue;
        losses[i] = try_hann(static_cast<int>(orders[i])) ? 0 : losses[i] + (hann_ > 0 ? 1 : 0);
      }
    }
  }

  /// Averages near the variance of the best Hann filter: equal ones, one half as long as the other, and a single one.
  void offer_averages() {
    constexpr double hann_variance = 0.0327;  // 1/12 - 1/(2 pi^2), of its length squared
    const double length = hann_ > 0 ? hann_ + 1.0 : first_length / task_.sample_period;
    const double square = 12.0 * hann_variance * length * length;
    for (const double factor : {1.0, 0.8, 1.25}) {
      for (const double part : {1.0, 0.5, 0.0}) {
        const double longest = factor * std::sqrt(square / (1.0 + part * part));
        averages_.offer({std::max(1, static_cast<int>(std::lround(longest))),
                         std::max(1, static_cast<int>(std::lround(part * longest)))});
      }
    }
  }

  /// s, of the plan with its drives cool; unlimited if it does not hold.
  double time_of(const Filter& set, const char* name) {
    const Filter filter = Response(task_.machine, task_.sample_period).command(set);
    for (const LimitUse& use : vibration_utilisation(filter, task_.sample_period, machine_)) {
      if (use.utilisation > 1.0) return unlimited;
    }
    ScheduledPlan plan = planned(filter);
    double time = unlimited;
    if (all_holds(plan.plan)) {
      const auto check = [&](ScheduledPlan& slower) {
        slower.plan = check_program(slower.path, filter, task_.sample_period, machine_, std::move(slower.plan.delays));
        count(slower.plan);
      };
      if (cool_drives(plan, filter, task_.sample_period, machine_, check, deadline_, cooling_trials) != Cooled::failed)
        time = static_cast<double>(plan.plan.simulation.samples) * task_.sample_period;
    }
    if (tell_ && time < unlimited) tell_(fmt::format("{}: {} taps, {:.4f} s simulated", name, set.order() + 1, time));
    return time;
  }

  /// With chosen feeds; at the programmed ones where these are kept or no plan of chosen feeds holds.
  ScheduledPlan planned(const Filter& filter) {
    if (!keep_ && (chosen_hold_ > 0 || chosen_broke_ < breaks_max)) {
      ScheduledPlan plan = schedule_feeds(path_, filter, task_.sample_period, machine_, mending_rounds, deadline_);
      count(plan.plan);
      ++(all_holds(plan.plan) ? chosen_hold_ : chosen_broke_);
      if (all_holds(plan.plan) || chosen_hold_ > 0) return plan;
    }
    ScheduledPlan plan{path_, {}};
    limit_rapids(plan.path, filter, task_.sample_period, machine_);
    snap_durations(plan.path, filter, task_.sample_period, machine_);
    plan.plan = plan_program(plan.path, filter, task_.sample_period, machine_, false, deadline_);
    count(plan.plan);
    return plan;
  }
  void count(const ProgramPlan& plan) { work_ += (plan.rounds + 1.0) * static_cast<double>(plan.simulation.samples); }

  const Toolpath& path_;
  const Task& task_;
  const Machine machine_;
  const bool keep_;
  const Deadline& deadline_;
  const std::function<void(const std::string&)>& tell_;
  TrialSearch averages_;
  std::map<int, double> times_;             // s, of Hann filters by their orders
  int hann_ = 0;                            // order of the best; 0: none holds
  int chosen_hold_ = 0, chosen_broke_ = 0;  // plans of chosen feeds
  double work_ = 0.0;
};

}  // namespace

bool needs_standard_shapes(const Toolpath& path, const Task& task) {
  const Machine machine = program_machine(task.machine, path);
  return has_ratings(machine) || path.contour_max < unlimited || !Response(machine, task.sample_period).common();
}

ProgramFilter fastest_standard_shape(const Toolpath& path, const Task& task, bool keep, const Deadline& deadline,
                                     const std::function<void(const std::string&)>& tell) {
  return Shapes(path, task, keep, deadline, tell).run();
}

}  // namespace accdec
