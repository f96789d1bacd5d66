#include <algorithm>
#include <chrono>
#include <cmath>
#include <vector>

#include <accdec/design/anytime.hpp>
#include <accdec/design/coarse_design.hpp>
#include <accdec/files.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/task/delays_by_formula.hpp>
#include <accdec/task/objective.hpp>
#include <accdec/task/order_bound.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

/// Least number of taps of the designs at the long period; a third more are usual. With more taps less is lost between
/// the periods, most where braking gives power back, but they may take too long.
constexpr int coarse_taps = 24, more_taps = 48;

bool bounds_regeneration(const Machine& machine) {
  return machine.regeneration_total_max < unlimited ||
         std::ranges::any_of(machine.axes, [](const Axis& axis) { return axis.regeneration_max < unlimited; });
}

/// By which whole number the period is lengthened for so many taps; 1 if not at all.
int longer_period(const Task& task, int known_order, int taps) {
  const bool measured =
      !task.machine.prefilter_taps.empty() ||
      std::ranges::any_of(task.machine.axes, [](const Axis& axis) { return !axis.response_taps.empty(); });
  if (task.filter || measured || task.corners.size() > 100) return 1;
  // Free taps are mostly shorter by less than this.
  constexpr double free_taps = 0.7;
  const int most = task.design.order_max, guess = static_cast<int>(free_taps * known_order);
  const int least = std::min(most, std::max(guess, order_lower_bound(task, most)));
  return least < 4 * taps ? 1 : least / taps;
}

Task at_longer_period(Task task, int times) {
  task.sample_period *= times;
  task.design.order_min = std::max(1, task.design.order_min / times);
  task.design.order_max = std::max(task.design.order_min, task.design.order_max / times);
  task.design.coefficient_bits = 0;
  for (TaskCorner& corner : task.corners) {
    if (corner.delay) corner.delay = (*corner.delay + times - 1) / times;
  }
  return task;
}

/// The filter's cumulative response, read `per_tap` times within a tap, behind a moving average.
Filter finer(const Filter& filter, double per_tap, int average) {
  std::vector<double> sums{0.0};
  for (int i = 0; i <= filter.order(); ++i) sums.push_back(sums.back() + filter.tap(i));
  const auto response = [&](double at) {
    const double last = static_cast<double>(sums.size() - 1);
    if (at >= last) return 1.0;
    const auto i = static_cast<std::size_t>(at);
    return sums[i] + (at - static_cast<double>(i)) * (sums[i + 1] - sums[i]);
  };
  const int count = static_cast<int>(std::ceil(per_tap * (filter.order() + 1) - 1e-9));
  std::vector<double> taps(static_cast<std::size_t>(count + average - 1), 0.0);
  for (int k = 0; k < count; ++k) {
    const double tap = std::max(0.0, response((k + 1) / per_tap) - response(k / per_tap)) / average;
    for (int j = 0; j < average; ++j) taps[static_cast<std::size_t>(k + j)] += tap;
  }
  return Filter(std::move(taps));
}

/// Whether all limits hold at exact stops, where no tolerance and no other leg counts. A filter that fails here fails
/// at every delay, which takes much longer to find. Behind a servo, the first leg ends with the servo's tail.
bool holds_alone(const Task& task, const Filter& filter) {
  const bool any_delay =
      std::ranges::all_of(task.corners, [](const TaskCorner& c) { return !c.delay && c.speed_min <= 0.0; });
  if (!any_delay) return true;
  Task first = task;
  first.corners.erase(first.corners.begin() + 1, first.corners.end());
  const int last = filter.order() + Response(task.machine, task.sample_period).order();
  return verify_by_simulation(first, filter, {last + 2}).feasible;
}

std::optional<DesignResult> from_longer_period(const Task& task, const DesignOptions& options, double seconds,
                                               int times) {
  if (times == 1) return std::nullopt;
  const auto began = std::chrono::steady_clock::now();
  DesignOptions coarse_options = options;
  coarse_options.time_limit = 0.7 * seconds;
  coarse_options.progress = nullptr;
  coarse_options.exact.certificate = false;
  const DesignResult coarse = design_anytime(at_longer_period(task, times), coarse_options);
  if (!coarse.has_design()) return std::nullopt;
  const auto stop = [&] {
    return seconds_since(began) > seconds || (options.cancel != nullptr && options.cancel->load());
  };
  const LinearCost cost = cost_of(task);
  std::optional<Filter> best;
  std::vector<int> best_delays;
  double least = unlimited;
  // An average of a long period keeps the jerk at any period: it comes first, as time may end the search.
  for (const int average : {times, 2 * times, times / 2, times / 4, 1}) {
    for (const double stretch : {0.96, 0.98, 1.0, 1.01, 1.02, 1.03, 1.04, 1.06, 1.08, 1.1, 1.15, 1.2, 1.3}) {
      const Filter filter = finer(*coarse.filter, times * stretch, std::max(1, average));
      if (stop() || filter.order() > task.design.order_max) break;
      if (!holds_alone(task, filter)) continue;
      // A filter at its limits may need long delays, where blends add its jerks up. A longer one may have shorter
      // delays.
      if (const auto delays = delays_by_formula(filter, task, least, stop))
        least = cost(filter.order(), *delays), best = filter, best_delays = *delays;
    }
  }
  if (!best) return std::nullopt;
  DesignResult result = assess(task, *best, best_delays, false);
  if (!result.has_design()) return std::nullopt;
  result.solver.method = "exact", result.solver.name = "longer period", result.solver.version = "accdec";
  return result;
}

}  // namespace

std::optional<DesignResult> coarse_design(const Task& task, const DesignOptions& options, double seconds,
                                          int known_order) {
  const auto began = std::chrono::steady_clock::now();
  auto best = from_longer_period(task, options, 0.6 * seconds, longer_period(task, known_order, coarse_taps));
  const double left = seconds - seconds_since(began);
  if ((best && !bounds_regeneration(task.machine)) || left <= 0.0) return best;
  auto closer = from_longer_period(task, options, left, longer_period(task, known_order, more_taps));
  return closer && (!best || closer->objective() < best->objective()) ? closer : best;
}

}  // namespace accdec
