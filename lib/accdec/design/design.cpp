#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/certificate.hpp>
#include <accdec/design.hpp>
#include <accdec/design/anytime.hpp>
#include <accdec/design/design_settings.hpp>
#include <accdec/design/differing_servos.hpp>
#include <accdec/design/quantise.hpp>
#include <accdec/design/taps_of_kinds.hpp>
#include <accdec/exact/exact.hpp>
#include <accdec/exact/size.hpp>
#include <accdec/files.hpp>
#include <accdec/machine/limits.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/task/contradictions.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

/// A local solver cannot prove that there is no design. The exact method may, so it gets a fifth of the time.
DesignResult local_or_proof(const Task& task, const DesignOptions& options) {
  const auto began = std::chrono::steady_clock::now();
  DesignOptions most = options;
  most.time_limit *= 0.8;
  DesignResult nlp = design_nlp(task, most);
  const bool cancelled = options.cancel != nullptr && options.cancel->load();
  if (nlp.has_design() || cancelled) return nlp;
  if (!Response(task.machine, task.sample_period).common()) return nlp;
  const ExactOptions exact = exact_options(options, options.time_limit - seconds_since(began));
  if (exact.time_limit <= 0.0) return nlp;
  DesignResult proof;
  try {
    proof = design_exact(task, exact);
  } catch (const exact::TooLarge&) {
    return nlp;
  }
  if (proof.status == Status::infeasible) return proof;
  if (proof.has_design()) {
    // The limits that the local search named are not in conflict.
    nlp.message = fmt::format("{} found no design{}; there is one: the exact method has {:g} ms", options.nlp.solver,
                              nlp.solver.claimed.empty() ? fmt::format(" ({})", nlp.message)
                                                         : fmt::format(" (last claim: {})", nlp.solver.claimed),
                              1e3 * proof.objective());
  }
  return nlp;
}

/// Searches that were cut off may leave a filter with longer delays than it needs; its own delays are found in a
/// moment.
DesignResult with_smallest_delays(DesignResult found, double seconds_left) {
  constexpr double always = 0.05;  // s, whatever the time limit
  if (found.status != Status::feasible || !found.filter) return found;
  Task given = found.task;
  const auto taps = found.filter->taps();
  given.filter = FilterSpec{.kind = Shape::taps, .taps = {taps.begin(), taps.end()}};
  DesignOptions options;
  options.time_limit = std::max(always, seconds_left);
  const DesignResult shorter = design_delays(given, options);
  if (!shorter.has_design() || !(shorter.objective() < found.objective() * (1.0 - 1e-12))) return found;
  std::vector<int> delays;
  for (const CornerResult& corner : shorter.corners) delays.push_back(corner.delay);
  DesignResult result = assess(found.task, *found.filter, delays, false);
  if (!result.has_design()) return found;
  result.message = found.message, result.stop = found.stop, result.solver = found.solver;
  result.lower_bound = found.lower_bound, result.certificate = found.certificate;
  judge_gap(result);
  return result;
}

}  // namespace

DesignResult design_task(const Task& task, const DesignOptions& options) {
  // An unknown solver is a usage error for every task.
  if (options.method == Method::nlp) solvers::find_solver(options.nlp.solver);
  const std::vector<std::string> conflicts = contradictions(task);
  if (!conflicts.empty()) {
    DesignResult result;
    result.task = task;
    result.status = Status::infeasible;
    result.message = fmt::format("limits in conflict: {}", fmt::join(conflicts, "; "));
    result.certificate = certify_contradiction(task);
    return result;
  }
  if (task.design.coefficient_bits > 0 && !task.filter) return design_quantised(task, options);
  if (task.settings) {
    const ControllerSettings& control = *task.settings;
    const bool family = control.names_family();
    if (family ? control.names(SettingFamily::taps) : !control.any_delay()) return design_taps_of_kinds(task, options);
    if (family) return design_settings(task, options);
  }
  if (task.filter) return design_delays(task, options);
  if (options.method == Method::exact && !Response(task.machine, task.sample_period).common())
    return design_differing(task, options);
  const auto began = std::chrono::steady_clock::now();
  DesignResult found = options.method == Method::exact ? design_anytime(task, options) : local_or_proof(task, options);
  if (found.status == Status::infeasible && task.settings && task.settings->names(DelayKind::corner_feed))
    found.message += "; corner-feed is not considered with free taps";
  return with_smallest_delays(std::move(found), options.time_limit - seconds_since(began));
}

}  // namespace accdec
