#include <chrono>
#include <functional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include <accdec/certificate/certificate.hpp>
#include <accdec/design/design.hpp>
#include <accdec/design/limit_rows.hpp>
#include <accdec/files/seconds_since.hpp>
#include <accdec/machine/limits.hpp>
#include <accdec/motion/smallest_delay.hpp>
#include <accdec/task/verification_cost.hpp>
#include <accdec/task/verifier.hpp>

namespace accdec {
namespace {

/// Whether one corner holds its axis limits and its smallest speed at a delay. Uses the blend formulas, for speed; the
/// final design is simulated.
bool holds(const Task& task, const TaskCorner& corner, const Filter& filter, int delay, std::string* broken) {
  const auto tell = [&](const LimitUse& use) {
    if (use.utilisation <= 1.0 + verification_tolerance) return true;
    *broken = describe(use);
    return false;
  };
  for (const LimitUse& use :
       axis_utilisation(filter, corner.geometry(), delay, task.sample_period, task.machine, corner.name)) {
    if (!tell(use)) return false;
  }
  const CornerMeasures measures = measure(Blend(filter, corner.geometry(), delay, task.sample_period));
  LimitUse use;
  use.corner = corner.name;
  use.event = Event::blend;
  if (corner.error_max && measures.corner_error > position_floor) {
    use.kind = LimitKind::corner_error;
    use.sample = measures.corner_error_sample;
    use.utilisation = utilisation_of(use.kind, measures.corner_error, *corner.error_max);
    if (!tell(use)) return false;
  }
  if (corner.speed_min > 0.0) {
    use.kind = LimitKind::speed_min;
    use.sample = measures.speed_min_sample;
    use.utilisation = utilisation_of(use.kind, measures.speed_min, corner.speed_min);
    if (!tell(use)) return false;
  }
  return true;
}

/// The delays of the corners as far as they were found.
struct FoundDelays {
  std::vector<int> delays;
  std::string impossible;   ///< why there are none; empty: there are
  bool unfinished = false;  ///< stopped before the last corner
  long tried = 0;
};

FoundDelays find_delays(const Task& task, const Filter& filter, const std::function<bool()>& stopped,
                        const std::function<void(const std::string&)>& progress) {
  const DelayFinder smallest(filter);
  const std::size_t told_every = 1 + task.corners.size() / 100;
  FoundDelays found;
  for (const TaskCorner& corner : task.corners) {
    const double period = task.sample_period;
    int delay = corner.delay.value_or(
        corner.error_max ? smallest(corner.geometry().cos_interior(), corner.geometry().feed_in * period,
                                    corner.geometry().feed_out * period, *corner.error_max)
                         : 0);
    // At N + 1 the legs no longer overlap, but the last step of one acceleration still meets the first of the other:
    // from N + 2 on nothing changes any more.
    const int last = corner.delay.value_or(std::max(delay, filter.order() + settling));
    std::string broken;
    while (++found.tried, !stopped() && !holds(task, corner, filter, delay, &broken) && delay < last) ++delay;
    if (stopped()) {
      found.unfinished = true;
      return found;
    }
    if (!holds(task, corner, filter, delay, &broken)) {
      found.impossible = corner.delay
                             ? fmt::format("this filter breaks a limit at the given delay: {}", broken)
                             : fmt::format("this filter breaks a limit at corner {} whatever its delay; at d = {}: {}",
                                           corner.name, delay, broken);
      return found;
    }
    found.delays.push_back(delay);
    if (progress && found.delays.size() % told_every == 0)
      progress(fmt::format("corner {}: d = {}", corner.name, delay));
  }
  return found;
}

/// The design, verified; every smaller delay was tried.
DesignResult verified(const Task& task, const Filter& filter, const std::vector<int>& delays) {
  DesignResult result = assess(task, filter, delays, false);
  if (result.status == Status::failed) {
    // Every corner holds its limits, so this is one the delays have no part in: vibration.
    DesignResult none;
    none.task = task;
    none.status = Status::infeasible;
    none.message = "this filter breaks a limit whatever the delays: " + result.verification.worst;
    return none;
  }
  result.status = Status::optimal;
  result.lower_bound = result.objective();
  result.gap = 0.0;
  result.certificate = std::make_shared<Certificate>(Certificate{proof::Enumeration{}});
  return result;
}

}  // namespace

DesignResult design_delays(const Task& task, const DesignOptions& options) {
  const auto began = std::chrono::steady_clock::now();
  const auto elapsed = [&] { return seconds_since(began); };
  const auto cancelled = [&] { return options.cancel != nullptr && options.cancel->load(); };
  const auto stopped = [&] { return elapsed() > options.time_limit || cancelled(); };
  const Filter filter = make_filter(*task.filter);
  const FoundDelays found = find_delays(task, filter, stopped, options.progress);
  const double simulation = verification_cost(task, filter.order(), found.delays).seconds();
  DesignResult result;
  result.task = task;
  if (found.unfinished) {
    result.stop = cancelled() ? StopReason::interrupted : StopReason::time_limit;
    result.message = fmt::format("stopped at corner {} of {}", found.delays.size() + 1, task.corners.size());
    if (!cancelled()) result.message += fmt::format("; the time limit is {:g} s", options.time_limit);
  } else if (!found.impossible.empty()) {
    result.status = Status::infeasible;
    result.message = found.impossible;
  } else if (simulation > 1.0 && elapsed() + simulation > options.time_limit) {
    result.stop = StopReason::time_limit;
    result.message = fmt::format("simulating all corners would take about {:.0f} s more; the time limit is {:g} s",
                                 simulation, options.time_limit);
  } else {
    result = verified(task, filter, found.delays);
  }
  result.solver.method = "given";
  result.solver.name = "enumeration";
  result.solver.evaluations = found.tried;
  result.solver.wall_time = elapsed();
  return result;
}

}  // namespace accdec
