#include <chrono>

#include <fmt/format.h>

#include <accdec/certificate/certificate.hpp>
#include <accdec/design/design.hpp>
#include <accdec/design/limit_rows.hpp>
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

}  // namespace

DesignResult design_delays(const Task& task, const DesignOptions& options) {
  const auto began = std::chrono::steady_clock::now();
  const auto elapsed = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count(); };
  const auto stopped = [&] {
    return elapsed() > options.time_limit || (options.cancel != nullptr && options.cancel->load());
  };
  const Filter filter = make_filter(*task.filter);
  const DelayFinder smallest(filter);
  std::vector<int> delays;
  std::string impossible, unfinished;
  long tried = 0;
  const std::size_t told_every = 1 + task.corners.size() / 100;
  for (const TaskCorner& corner : task.corners) {
    const double period = task.sample_period;
    int delay = corner.delay.value_or(
        corner.error_max ? smallest(corner.geometry().cos_interior(), corner.geometry().feed_in * period,
                                    corner.geometry().feed_out * period, *corner.error_max)
                         : 0);
    // At N + 1 the legs no longer overlap, but the last step of one acceleration still meets the first of the other:
    // from N + 2 on nothing changes any more.
    const int last = corner.delay.value_or(std::max(delay, filter.order() + 2));
    std::string broken;
    while (++tried, !stopped() && !holds(task, corner, filter, delay, &broken) && delay < last) ++delay;
    if (stopped()) {
      unfinished = fmt::format("stopped at corner {} of {}", delays.size() + 1, task.corners.size());
      break;
    }
    if (!holds(task, corner, filter, delay, &broken)) {
      impossible = fmt::format("this filter breaks a limit at corner {} whatever its delay; at d = {}: {}", corner.name,
                               delay, broken);
      if (corner.delay) impossible = fmt::format("this filter breaks a limit at the given delay: {}", broken);
      break;
    }
    delays.push_back(delay);
    if (options.progress && delays.size() % told_every == 0)
      options.progress(fmt::format("corner {}: d = {}", corner.name, delay));
  }
  if (const double seconds = verification_cost(task, filter.order(), delays).seconds();
      unfinished.empty() && seconds > 1.0 && elapsed() + seconds > options.time_limit) {
    unfinished = fmt::format("simulating all corners would take about {:.0f} s more", seconds);
  }
  DesignResult result;
  if (!unfinished.empty()) {
    result.task = task;
    result.message = unfinished + fmt::format("; the time limit is {:g} s", options.time_limit);
  } else if (impossible.empty()) {
    result = assess(task, filter, delays, false);
    if (result.status == Status::failed) {
      // Every corner holds its limits, so this is one the delays have no part in: vibration.
      result.status = Status::infeasible;
      result.message = "this filter breaks a limit whatever the delays: " + result.verification.worst;
    } else {
      result.status = Status::optimal;
      result.lower_bound = result.objective();
      result.gap = 0.0;
      result.certificate = std::make_shared<Certificate>(Certificate{proof::Enumeration{}});
    }
  } else {
    result.task = task;
    result.status = Status::infeasible;
    result.message = impossible;
  }
  result.solver.method = "given";
  result.solver.name = "enumeration";
  result.solver.evaluations = tried;
  result.solver.wall_time = elapsed();
  return result;
}

}  // namespace accdec
