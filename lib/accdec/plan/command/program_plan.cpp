#include <algorithm>
#include <cmath>

#include <accdec/machine/response.hpp>
#include <accdec/plan/command/program_plan.hpp>
#include <accdec/plan/command/repair.hpp>
#include <accdec/plan/delays/control_delays.hpp>
#include <accdec/plan/feeds/contour_feeds.hpp>
#include <accdec/plan/feeds/control_delay.hpp>
#include <accdec/plan/feeds/curve_feeds.hpp>
#include <accdec/simulate/sample_check.hpp>
#include <accdec/task/blend_limits.hpp>
#include <accdec/task/delay_kinds.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

ProgramPlan simulate_plan(const Toolpath& path, const Filter& filter, double sample_period, const Machine& machine,
                          std::vector<int> delays, bool blame, bool least) {
  ProgramPlan plan;
  plan.delays = std::move(delays);
  plan.errors.assign(path.blocks(), 0.0);
  const CommandTiming timing(path, sample_period, plan.delays);
  SimulationOptions options;
  if (!machine.axes.empty()) options.machine = &machine;
  options.blame = blame;
  options.whole_windows = least;
  const FilterBehind behind(filter, machine, sample_period);
  options.motion = behind.servo();
  plan.simulation = simulate_program(timing, filter, 0, path.blocks() - 1, plan.errors, options);
  plan.errors_hold = true;
  for (std::size_t b = 0; b + 1 < path.blocks() && plan.errors_hold; ++b) {
    plan.errors_hold = holds(plan.errors[b], path.tolerance[b]);
  }
  return plan;
}

}  // namespace

bool all_holds(const ProgramPlan& plan) {
  return plan.errors_hold && plan.delays_had &&
         std::all_of(plan.simulation.limits.begin(), plan.simulation.limits.end(),
                     [](const LimitUse& use) { return use.utilisation <= 1.0 + verification_tolerance; });
}

void limit_rapids(Toolpath& path, const Filter& filter, double sample_period, const Machine& machine) {
  if (machine.axes.empty()) return;
  const BlendLimits limits(filter, machine, sample_period);
  const std::size_t n = path.dimensions();
  std::vector<double> velocity(n);
  for (std::size_t b = 0; b < path.blocks(); ++b) {
    if (path.rapid[b] == 0) continue;
    const double* p = path.point(b);
    for (std::size_t i = 0; i < n; ++i) velocity[i] = (p[n + i] - p[i]) / path.duration[b];
    path.duration[b] /= limits.start_factor(velocity.data());
  }
}

namespace {

/// Calls act(first, last, factor) for every sequence of blocks up to one that `ends`, if it exceeds whole samples by at
/// most the part `most` of itself.
template <class Ends, class Act>
void for_snapped(const Toolpath& path, double sample_period, double most, const Ends& ends, const Act& act) {
  for (std::size_t first = 0, b = 0; b < path.blocks(); first = ++b) {
    while (b + 1 < path.blocks() && !ends(b)) ++b;
    double duration = 0.0;
    for (std::size_t i = first; i <= b; ++i) duration += path.duration[i];
    const double samples = duration / sample_period, whole = std::floor(samples);
    if (whole < 1.0 || samples - whole <= 1e-9 || samples - whole > most * samples) continue;
    act(first, b, whole / samples);
  }
}

}  // namespace

bool snap_runs(Toolpath& path, double sample_period, const std::vector<int>& delays) {
  bool snapped = false;
  const auto ends = [&](std::size_t b) { return ends_leg(path, b) || delays[b] > 0; };
  for_snapped(path, sample_period, 1e-7, ends, [&](std::size_t first, std::size_t last, double factor) {
    for (std::size_t i = first; i <= last; ++i) path.duration[i] *= factor;
    snapped = true;
  });
  return snapped;
}

void snap_durations(Toolpath& path, const Filter& filter, double sample_period, const Machine& machine) {
  const BlendLimits limits(filter, machine, sample_period);
  const std::size_t n = path.dimensions();
  std::vector<double> velocity(n);
  const auto ends = [&](std::size_t b) { return ends_leg(path, b); };
  for_snapped(path, sample_period, 1e-6, ends, [&](std::size_t first, std::size_t last, double factor) {
    bool held = true;
    for (std::size_t i = first; i <= last && held; ++i) {
      const double* p = path.point(i);
      for (std::size_t a = 0; a < n; ++a) velocity[a] = (p[n + a] - p[a]) / (path.duration[i] * factor);
      held = limits.start_factor(velocity.data()) >= 1.0;
    }
    for (std::size_t i = first; i <= last && held; ++i) path.duration[i] *= factor;
  });
}

void ready_feeds(Toolpath& path, const Filter& filter, double sample_period, const Machine& machine) {
  limit_rapids(path, filter, sample_period, machine);
  snap_durations(path, filter, sample_period, machine);
  hold_contour(path, FilterBehind(filter, machine, sample_period), sample_period);
}

namespace {

/// Whether no stop lasts longer than the control's own: as long as the motion, and a sample more where a limit asks.
bool stops_had(const Toolpath& path, const Filter& filter, double sample_period, const Machine& machine,
               const std::vector<int>& delays) {
  const int motion = FilterBehind(filter, machine, sample_period).longest_order() - filter.order();
  const int most = exact_stop_delay(filter) + motion + exact_stop_more;
  for (std::size_t b = 0; b + 1 < path.blocks(); ++b) {
    if (path.joint[b] == Joint::stop && delays[b] > most) return false;
  }
  return true;
}

}  // namespace

void settle_delays(const Toolpath& path, const Filter& filter, double sample_period, const Machine& machine,
                   ProgramPlan& plan) {
  if (path.control.any()) return;
  CommandDelays found = command_delays(path, filter, sample_period, plan.delays);
  plan.delays_had = found.wrong.empty() && stops_had(path, filter, sample_period, machine, found.delays);
  if (!plan.delays_had || found.delays == plan.delays) return;
  ProgramPlan settled = check_program(path, filter, sample_period, machine, std::move(found.delays));
  settled.slowed = plan.slowed;
  settled.too_fast = std::move(plan.too_fast);
  settled.rounds = plan.rounds;
  plan = std::move(settled);
}

ProgramPlan check_program(const Toolpath& path, const Filter& filter, double sample_period, const Machine& machine,
                          std::vector<int> delays, bool least) {
  return simulate_plan(path, filter, sample_period, machine, std::move(delays), false, least);
}

namespace {

ProgramPlan plan_with(Toolpath& path, const Filter& filter, double sample_period, const Machine& machine,
                      const Deadline& deadline, bool ramps) {
  PairwiseDelays pairwise = pairwise_delays(path, filter, sample_period, machine);
  std::vector<SlowedFeeds> too_fast = limit_feeds(path, filter, sample_period, machine, pairwise, ramps, deadline);
  const auto keep_given = [&] {
    for (const auto& [block, delay] : path.given_delays) {
      int& d = pairwise.delays[block];
      d = std::max(d, static_cast<int>(std::lround(std::min(delay / sample_period, 1e9))));
    }
  };
  keep_given();
  const bool mend_limits = !machine.axes.empty();
  ProgramPlan plan = simulate_plan(path, filter, sample_period, machine, pairwise.delays, mend_limits, true);
  plan.too_fast = too_fast;
  const auto know_alone = [&] {
    if (path.given_delays.empty()) plan.alone = std::move(pairwise.delays);
  };
  if (plan.errors_hold && plan.simulation.broken.empty() && plan.simulation.off.empty()) {
    know_alone();
    return plan;
  }
  Repair repair(path, filter, sample_period, mend_limits ? &machine : nullptr, plan.delays, plan.errors);
  RepairWork failing = repair.failing(plan.simulation);
  int rounds = 0;
  // Far more than any program needed. A tolerance below the arithmetic's precision would never be met.
  constexpr int most_rounds = 2000;
  while (!failing.empty() && rounds < most_rounds && !deadline.over()) {
    ++rounds;
    failing = repair.round(failing, 1 + rounds / 8);
  }
  // At lowered feeds a joint alone may do with less than at the feeds before.
  pairwise = pairwise_delays(path, filter, sample_period, machine);
  keep_given();
  for (std::size_t b = 0; b < path.blocks() && !deadline.over(); ++b) {
    if (plan.delays[b] > pairwise.delays[b]) repair.lower(b, pairwise.delays[b]);
  }
  plan = check_program(path, filter, sample_period, machine, std::move(plan.delays));
  know_alone();
  plan.rounds = rounds;
  plan.too_fast = std::move(too_fast);
  return plan;
}

/// A plan that starts from the path's feeds, with the delays that the control gives. Feeds above the limits are reached
/// in steps, each within the limits. If several blocks fit into one filter length, steps can still add up. Then every
/// block gets a feed it can start and stop from.
ProgramPlan plan_at_feeds(Toolpath& path, const Filter& filter, double sample_period, const Machine& machine,
                          const Deadline& deadline) {
  const std::vector<double> before = path.duration;
  ProgramPlan plan = plan_with(path, filter, sample_period, machine, deadline, true);
  settle_delays(path, filter, sample_period, machine, plan);
  if (plan.too_fast.empty() || all_holds(plan) || deadline.over()) return plan;
  std::vector<double> ramped = path.duration;
  path.duration = before;
  ProgramPlan slow = plan_with(path, filter, sample_period, machine, deadline, false);
  settle_delays(path, filter, sample_period, machine, slow);
  if (all_holds(slow)) return slow;
  path.duration = std::move(ramped);
  return plan;
}

/// Plans the curves of a program at other feeds, and keeps the fastest plan of every curve. Curves are tried
/// together, with one plan of the whole program for each step, since they hardly affect each other. The plan kept has
/// been planned and simulated as a whole.
class CurveTrials {
 public:
  CurveTrials(Toolpath& path, const Filter& filter, double sample_period, const Machine& machine, ProgramPlan plan,
              std::vector<double> programmed, const Deadline& deadline)
      : path_(path),
        deadline_(deadline),
        filter_(filter),
        period_(sample_period),
        machine_(machine),
        programmed_(std::move(programmed)),
        best_(std::move(plan)),
        best_duration_(path.duration) {
    path_.duration = programmed_;
    const FilterBehind behind(filter_, machine_, period_);
    feeds_ = curve_feeds(path_, behind, period_, best_.delays, best_duration_, joints_max);
    for (const Curve& curve : feeds_.curves) {
      choices_.push_back({0.0, curve_time(curve, best_duration_, best_.delays, period_)});
    }
  }

  ProgramPlan run() {
    if (!choices_.empty()) {
      int left = static_cast<int>(std::clamp<std::size_t>(work_max / path_.blocks(), 3, 16));
      for (const double scale : {1.0, 0.7, 1.4, 0.5, 2.0, 2.8}) {
        if (left-- > 0) trial([&](const Choice&) { return scale; });
      }
      for (double step = std::pow(2.0, 0.25); left > 1; step = std::sqrt(step), left -= 2) {
        const std::vector<Choice> around = choices_;
        for (const double factor : {step, 1.0 / step}) {
          std::size_t i = 0;
          trial([&](const Choice&) { return around[i++].scale * factor; });
        }
      }
      trial([](const Choice& choice) { return choice.scale; });
    }
    path_.duration = best_duration_;
    return std::move(best_);
  }

 private:
  static constexpr std::size_t joints_max = 300'000, work_max = 1'000'000;
  struct Choice {
    double scale;  // of the feeds at which a curve needs no delay; 0: the programmed feed
    double time;   // s
  };

  /// @param scale_of  the scale for planning a curve, by its choice so far; called in their order
  template <class ScaleOf>
  void trial(const ScaleOf& scale_of) {
    path_.duration = programmed_;
    std::vector<double> scales;
    bool same = true;
    for (std::size_t i = 0; i < choices_.size(); ++i) {
      const double scale = scales.emplace_back(scale_of(choices_[i]));
      for (std::size_t b = feeds_.curves[i].first; b <= feeds_.curves[i].last && scale > 0.0; ++b) {
        path_.duration[b] = std::max(programmed_[b], feeds_.duration[b] / scale);
        same = same && path_.duration[b] == programmed_[b];
      }
    }
    if (same || deadline_.over()) return;
    ProgramPlan plan = plan_at_feeds(path_, filter_, period_, machine_, deadline_);
    if (!all_holds(plan)) return;
    for (std::size_t i = 0; i < choices_.size(); ++i) {
      const double time = curve_time(feeds_.curves[i], path_.duration, plan.delays, period_);
      if (time < choices_[i].time) choices_[i] = {scales[i], time};
    }
    if (all_holds(best_) && plan.simulation.samples >= best_.simulation.samples) return;
    best_ = std::move(plan);
    best_duration_ = path_.duration;
  }

  Toolpath& path_;
  const Deadline& deadline_;
  const Filter& filter_;
  double period_;
  const Machine& machine_;
  const std::vector<double> programmed_;
  ProgramPlan best_;
  std::vector<double> best_duration_;
  CurveFeeds feeds_;
  std::vector<Choice> choices_;  // of every curve
};

}  // namespace

ProgramPlan plan_program(Toolpath& path, const Filter& filter, double sample_period, const Machine& machine,
                         bool tune_curves, const Deadline& deadline) {
  const std::vector<double> programmed = path.duration;
  ProgramPlan plan = plan_at_feeds(path, filter, sample_period, machine, deadline);
  if (tune_curves) {
    plan = CurveTrials(path, filter, sample_period, machine, std::move(plan), programmed, deadline).run();
  }
  for (std::size_t b = 0; b < path.blocks(); ++b) plan.slowed += path.duration[b] > programmed[b] ? 1 : 0;
  return plan;
}

}  // namespace accdec
