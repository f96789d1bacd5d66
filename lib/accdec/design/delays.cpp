#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include <accdec/certificate.hpp>
#include <accdec/corner.hpp>
#include <accdec/design.hpp>
#include <accdec/design/limit_rows.hpp>
#include <accdec/files.hpp>
#include <accdec/machine/blend_behind.hpp>
#include <accdec/machine/limits.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/task/blend_check.hpp>
#include <accdec/task/blend_limits.hpp>
#include <accdec/task/corner_feed.hpp>
#include <accdec/task/verification_cost.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

/// Whether one corner holds its limits at a delay, as the simulation sees it. Smaller delays than the result's count as
/// proved not to hold. So the simulation decides where the formulas are close to a bound; a search of filters claims
/// nothing by them, and takes one slack (BlendCheck::holds).
class CornerCheck {
 public:
  /// @param simulate  whether even what the formulas are sure of is simulated  @param limits  of the filter
  CornerCheck(const Task& task, const TaskCorner& corner, const Filter& filter, const FilterBehind& behind,
              const BlendLimits& limits, bool simulate)
      : task_(task),
        corner_(corner),
        filter_(filter),
        behind_(behind),
        simulate_(simulate),
        blend_(behind, corner, task, limits) {}

  bool holds(int delay) {
    const Verdict verdict = simulate_ ? Verdict::close : blend_.verdict(delay);
    return verdict == Verdict::close ? simulated(delay).feasible : verdict == Verdict::held;
  }
  /// The limit that is broken at a delay that does not hold: the first if formulas refused it, otherwise the worst.
  std::string broken(int delay) const {
    std::vector<LimitUse> uses;
    const VerificationReport report = simulated(delay, &uses);
    if (!simulate_ && behind_.ideal()) {
      for (const LimitUse& use : uses) {
        if (verdict_by_formula(use.utilisation) == Verdict::broken) return describe(use);
      }
    }
    return report.worst;
  }

 private:
  VerificationReport simulated(int delay, std::vector<LimitUse>* uses = nullptr) const {
    return verify_by_simulation(corner_alone(task_, corner_), filter_, {delay}, uses);
  }

  const Task& task_;
  const TaskCorner& corner_;
  const Filter& filter_;
  const FilterBehind& behind_;
  bool simulate_;
  BlendCheck blend_;
};

/// The delays of the corners found so far.
struct FoundDelays {
  std::vector<int> delays;
  std::string impossible;   ///< why there are none; empty if there are
  bool unfinished = false;  ///< stopped before the last corner
  bool unproved = false;    ///< longer delays than those tried may hold: modes of axes change with every delay
  long tried = 0;
};

FoundDelays find_delays(const Task& task, const Filter& filter, bool simulate, const std::function<bool()>& stopped,
                        const std::function<void(const std::string&)>& progress) {
  const Response response(task.machine, task.sample_period);
  const FilterBehind behind(filter, task.machine, task.sample_period);
  const BlendLimits limits(filter, task.machine, task.sample_period);
  std::optional<DelayFinder> smallest;  // where the error falls with the delay
  if (response.common()) smallest.emplace(behind.motion());
  const std::size_t told_every = 1 + task.corners.size() / 100;
  FoundDelays found;
  for (const TaskCorner& corner : task.corners) {
    const int least = corner.delay.value_or(
        corner.error_max && smallest
            ? delay_for_error(*smallest, corner.geometry(), task.sample_period, granted_error(*corner.error_max))
            : 0);
    // From N + 1 on, the legs do not overlap, but the last step of one acceleration still meets the first of the other.
    // From N + 2 on nothing changes, except for the phase of modes of axes.
    const int last = corner.delay.value_or(std::max(least, last_delay(task, filter.order() + response.order())));
    CornerCheck check(task, corner, filter, behind, limits, simulate);
    const auto holds = [&](int d) { return ++found.tried, !stopped() && check.holds(d); };
    const std::optional<int> delay = first_delay(least, last, holds, [&](int) { return stopped(); });
    if (stopped()) {
      found.unfinished = true;
      return found;
    }
    if (!delay) {
      const std::string broken = check.broken(last);
      found.impossible = corner.delay
                             ? fmt::format("this filter breaks a limit at the given delay: {}", broken)
                             : fmt::format("this filter breaks a limit at corner {} whatever its delay; at d = {}: {}",
                                           corner.name, last, broken);
      found.unproved = !corner.delay && has_mode_of_axis(task.machine);
      return found;
    }
    found.delays.push_back(*delay);
    if (progress && found.delays.size() % told_every == 0)
      progress(fmt::format("corner {}: d = {}", corner.name, *delay));
  }
  return found;
}

/// Whether the filter holds the limits in which delays have no part.
bool is_quiet(const Task& task, const Filter& filter) {
  Task filter_alone = task;
  filter_alone.corners.clear();
  return verify_by_simulation(filter_alone, filter, {}).feasible;
}

constexpr const char* slower = "corner-feed was not tried: it is not considered with a given filter";

/// The design, verified; every smaller delay was tried.
DesignResult verified(const Task& task, const Filter& filter, const std::vector<int>& delays) {
  DesignResult result = assess(task, filter, delays, false);
  if (result.status == Status::failed) {
    if (!is_quiet(task, filter)) {
      result.status = Status::infeasible;
      result.message = "this filter breaks a limit whatever the delays: " + result.verification.worst;
    }
    result.verification = {};
    result.limits.clear();
    return result;
  }
  if (may_pass_slower(task)) {
    result.message = slower;
    return result;
  }
  result.status = Status::optimal;
  result.lower_bound = result.objective();
  result.gap = 0.0;
  result.certificate = std::make_shared<Certificate>(Certificate{proof::Enumeration{}});
  return result;
}

/// @param simulate  as of CornerCheck
DesignResult try_delays(const Task& task, const Filter& filter, bool simulate, const DesignOptions& options,
                        const std::function<double()>& elapsed) {
  const auto cancelled = [&] { return options.cancel != nullptr && options.cancel->load(); };
  const auto stopped = [&] { return elapsed() > options.time_limit || cancelled(); };
  const FoundDelays found = find_delays(task, filter, simulate, stopped, options.progress);
  const double simulation = verification_cost(task, filter.order(), found.delays).seconds();
  DesignResult result;
  result.task = task;
  if (found.unfinished) {
    result.stop = cancelled() ? StopReason::interrupted : StopReason::time_limit;
    result.message = fmt::format("stopped at corner {} of {}", found.delays.size() + 1, task.corners.size());
    if (!cancelled()) result.message += fmt::format("; the time limit is {:g} s", options.time_limit);
  } else if (!found.impossible.empty()) {
    result.status = found.unproved || may_pass_slower(task) ? Status::failed : Status::infeasible;
    result.message = found.impossible;
    if (found.unproved) result.message += "; longer delays were not tried";
    if (may_pass_slower(task)) result.message += fmt::format("; {}", slower);
  } else if (simulation > 1.0 && elapsed() + simulation > options.time_limit) {
    result.stop = StopReason::time_limit;
    result.message = fmt::format("simulating all corners would take about {:.0f} s more; the time limit is {:g} s",
                                 simulation, options.time_limit);
  } else {
    result = verified(task, filter, found.delays);
  }
  result.solver.evaluations = found.tried;
  return result;
}

}  // namespace

DesignResult design_delays(const Task& task, const DesignOptions& options) {
  const auto began = std::chrono::steady_clock::now();
  const auto elapsed = [&] { return seconds_since(began); };
  const Filter filter = make_filter(*task.filter);
  DesignResult result = try_delays(task, filter, false, options, elapsed);
  // With thousands of taps the simulation may round more than the formulas allow for.
  if (result.status == Status::failed && result.stop == StopReason::finished)
    result = try_delays(task, filter, true, options, elapsed);
  result.solver.method = "given";
  result.solver.name = "enumeration";
  result.solver.wall_time = elapsed();
  return result;
}

}  // namespace accdec
