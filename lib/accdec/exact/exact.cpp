#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include <accdec/exact/exact.hpp>
#include <accdec/exact/joint.hpp>
#include <accdec/exact/minimal_conflict.hpp>
#include <accdec/exact/search.hpp>
#include <accdec/motion/shapes.hpp>
#include <accdec/task/contradictions.hpp>
#include <accdec/task/objective.hpp>
#include <accdec/task/order_bound.hpp>
#include <accdec/task/verifier.hpp>

namespace accdec {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// As many linear programs make a short proof.
constexpr long shortly = 2000;

bool convex(const Task& task) {
  for (const Axis& axis : task.machine.axes) {
    if (axis.power_max < unlimited || axis.regeneration_max < unlimited) return false;
  }
  return std::none_of(task.corners.begin(), task.corners.end(), [](const TaskCorner& c) { return c.speed_min > 0.0; });
}

/// Designs that hold limits outside the convex class, where the search itself has none to offer.
void offer_shapes(const Task& task, exact::Search& search, int least, const std::function<bool()>& stop) {
  const LinearCost cost = cost_of(task);
  if (const auto taps = saturating_start(task, task.design.order_max); !taps.empty()) search.offer(Filter(taps));
  for (int n = std::max(least, 2); n <= task.design.order_max && !stop(); ++n) {
    const double shortest = cost(n, std::vector<int>(task.corners.size(), 0));
    if (search.best && shortest >= search.best->value) break;
    search.offer(boxcar(n));
    for (int ramp = 1; ramp <= n / 2; ramp += std::max(1, n / 16)) search.offer(trapezoid(n, ramp));
    search.offer(hann(n));
  }
}

/// Bytes of the dense tableau of the linear programs' first rows, which hold for every box.
double tableau_bytes(const Task& task, int order) {
  double rows = 1.0;
  for (const Axis& axis : task.machine.axes) {
    if (axis.force_max < unlimited && axis.damping > 0.0) rows += order + 1.0;
  }
  if (std::any_of(task.machine.axes.begin(), task.machine.axes.end(),
                  [](const Axis& axis) { return axis.jerk_max < unlimited; }))
    rows += order + 2.0;
  return sizeof(double) * rows * (order + 2.0 + rows);
}
constexpr double most_bytes = 2e9;

/// The next target between a bound and what is known to be open or found above it.
double next_target(double low, double high) {
  for (const double part : {0.8, 0.9, 0.95, 0.97, 0.985}) {
    if (part * high > low * (1.0 + 1e-3)) return part * high;
  }
  return high;
}

}  // namespace

DesignResult design_exact(const Task& task, const ExactOptions& options) {
  const auto began = std::chrono::steady_clock::now();
  const auto elapsed = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count(); };
  const auto stop = [&] {
    return elapsed() > options.time_limit || (options.cancel != nullptr && options.cancel->load());
  };
  DesignResult result;
  result.task = task;
  result.solver.method = "exact";
  result.solver.name = "dual simplex", result.solver.version = "accdec";
  const double period = task.sample_period;
  if (const auto impossible = contradictions(task); !impossible.empty()) {
    result.status = Status::infeasible;
    result.message = impossible.front();
    if (options.certificate) result.certificate = std::make_shared<Certificate>(Certificate{proof::ConstantFeed{}});
    result.solver.wall_time = elapsed();
    return result;
  }

  // No order below is allowed or fast enough; a linear program of that size has to fit into memory.
  const int first_order = std::max(task.design.order_min, order_lower_bound(task, task.design.order_max));
  if (const double bytes = tableau_bytes(task, first_order); bytes > most_bytes) {
    result.status = Status::failed;
    result.message = fmt::format(
        "the linear programs for filters of order {} would take {:.1f} GB of memory, more than "
        "the {:.0f} GB allowed; a longer sample period or a nonlinear solver (--solver) may do",
        first_order, bytes / 1e9, most_bytes / 1e9);
    result.solver.wall_time = elapsed();
    return result;
  }

  exact::Search search(task, stop);
  if (options.start) search.offer(*options.start);
  const int least = search.smallest_order();
  const bool is_convex = convex(task);
  const bool several = task.corners.size() > 1;
  // Symmetric filters are no part of the joint proof.
  const bool jointly = several && !task.design.symmetric;
  if (!is_convex || several) offer_shapes(task, search, least, stop);
  if (several) {
    search.sweep_orders(least);
    if (!jointly) search.improve();
  }
  const LinearCost cost = cost_of(task);
  const double fixed = cost.given_delays(task);
  double weights = 0.0;
  for (const double w : cost.delay) weights += w;
  // Proved by nothing but the task's bounds.
  double low = cost.filter * (std::max(task.design.order_min, 0) + 1) + fixed;
  double high = search.best ? search.best->value : infinity;  // the shortest known to hold the convex limits
  double trial = std::max(low, cost.filter * (least + 1) + fixed);
  const double longest = cost.filter * (task.design.order_max + 1.0) + weights * (task.design.order_max + 2.0) + fixed;
  bool proved = false, infeasible = false;
  const auto tell = [&] {
    if (!options.progress) return;
    const double incumbent = search.best ? search.best->value * period : infinity;
    options.progress({low * period, incumbent, search.best ? (incumbent - low * period) / incumbent : 1.0});
  };
  const double step = 1.5 * weights;
  long joint_programmes = 0;
  // A proof that is short goes for the best design at once; a long one moves its bound target by target.
  const bool straight = search.best && task.corners.size() == 1 && options.gap == 0.0;
  auto answer = straight ? exact::Search::Answer::found : exact::Search::Answer::unknown;
  double open = infinity;  // the least target with a part in which rounding decides
  while (!stop() && answer == exact::Search::Answer::found) {
    answer = search.minimise(high, shortly - search.linear_programs());
    if (answer == exact::Search::Answer::open) open = std::min(open, high);
    high = std::min(high, search.best->value);
    if (answer == exact::Search::Answer::proved) low = search.proof.target, proved = low >= high;
    tell();
  }
  const auto close_enough = [&] {
    return options.gap > 0.0 && search.proof.target > 0.0 && search.best && high - low <= options.gap * high;
  };
  bool rounding = false;  // decides what is left of the joint proof
  if (jointly && search.best) {
    exact::Joint joint(task, search, least, stop);
    using State = exact::Joint::State;
    State state = State::going_on;
    const double at_least = low;
    while (state == State::going_on) {
      state = joint.step();
      const double before = low, found = high;
      low = std::max(low, joint.bound());
      high = search.best->value;
      if (low > before || high < found) tell();
      if (options.gap > 0.0 && high - low <= options.gap * high) break;
    }
    rounding = true;
    // What is said in the end is what the certificate shows.
    low = at_least;
    if (auto proof = joint.proof()) search.proof = std::move(*proof), low = std::max(low, search.proof.target);
    proved = low >= high;
    joint_programmes = joint.linear_programs();
  }
  while (!stop() && !proved && !rounding && !close_enough()) {
    double target = std::min(high, open);
    if (open <= high && high < infinity) {
      // The bound can still rise to where the open part begins.
      target = 0.5 * (low + open);
      if (cost.whole()) target = std::floor(target);
      if (target <= low || open - low <= 1e-3 * open) break;
    } else if (options.gap > 0.0 && high < infinity) {
      target = std::max(0.5 * (low + high), (1.0 - options.gap) * high);
      if (cost.whole()) target = std::ceil(target);
    } else if (high == infinity) {
      trial = std::max(trial + step, 1.3 * trial);
      target = trial >= longest ? infinity : trial;
    } else if (high - low > step) {
      target = trial > low && trial < high && low < 0.9 * trial ? trial : 0.5 * (low + high);
      // With several corners a proof grows fast with its target, and a better design ends it: in large steps.
      if (several) target = next_target(low, high);
      if (cost.whole()) target = std::floor(target) + 0.0;
      if (target <= low || target >= high) target = high;
    }
    answer = search.below(target);
    if (answer == exact::Search::Answer::unknown) break;
    if (several && answer == exact::Search::Answer::found) search.improve();
    if (answer == exact::Search::Answer::open) open = std::min(open, target);
    if (open == infinity && answer == exact::Search::Answer::open) break;
    if (search.best) high = std::min(high, search.best->value);
    if (answer == exact::Search::Answer::proved) {
      low = std::max(low, target);
      if (target == infinity) infeasible = true;
      if (low >= high || infeasible) proved = true;
    }
    tell();
    if (proved) break;
  }
  if (!infeasible && is_convex && !search.best) offer_shapes(task, search, least, stop);

  if (infeasible) {
    result.status = Status::infeasible;
    const exact::Conflict conflict = exact::find_conflict(task, stop);
    result.message = exact::to_message(conflict, task);
    search.proof.conflict = conflict.limits;
  } else {
    if (search.best) {
      const exact::Candidate& best = *search.best;
      const double claimed = best.value;
      result = assess(task, best.filter, best.delays, false);
      result.solver.method = "exact";
      result.solver.name = "dual simplex", result.solver.version = "accdec";
      result.lower_bound = std::min(low, claimed) * period;
      result.gap = std::max(0.0, (result.objective() - *result.lower_bound) / result.objective());
      if (result.status == Status::feasible && low >= claimed * (1.0 - 1e-9)) result.status = Status::optimal;
    } else {
      result.status = Status::failed;
      result.lower_bound = low * period;
      result.message =
          stop()      ? "stopped before a design was found"
          : is_convex ? "no design was found, but none could be excluded either: some limit can be held only to within "
                        "rounding; a design may be found with that limit a little wider"
                      : "no design was found that holds power, regeneration and the smallest speeds as well, but it is "
                        "not proved that there is none";
    }
    if (result.status != Status::optimal && stop())
      result.stop =
          options.cancel != nullptr && options.cancel->load() ? StopReason::interrupted : StopReason::time_limit;
    else if (result.status == Status::feasible && close_enough())
      result.stop = StopReason::gap_reached;
    if (result.status == Status::feasible) {
      result.message =
          stop() ? "stopped before the proof was complete"
          : close_enough()
              ? "stopped at the gap asked for"
              : "the limits can be held only to within rounding at anything shorter: whether there is such a "
                "design is open";
    }
  }
  if (options.certificate && search.proof.target > 0.0) result.certificate = exact::certify(search.proof, task.design);
  result.solver.evaluations = search.linear_programs() + joint_programmes;
  result.solver.wall_time = elapsed();
  return result;
}

}  // namespace accdec
