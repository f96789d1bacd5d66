#include <algorithm>
#include <chrono>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/certificate/checker.hpp>
#include <accdec/design/anytime.hpp>
#include <accdec/design/design.hpp>
#include <accdec/exact/exact.hpp>
#include <accdec/exact/size.hpp>
#include <accdec/files/seconds_since.hpp>
#include <accdec/task/contradictions.hpp>

namespace accdec {
namespace {

ExactOptions exact_options(const DesignOptions& options) {
  ExactOptions exact;
  exact.time_limit = options.time_limit;
  exact.gap = options.gap;
  exact.cancel = options.cancel;
  exact.certificate = options.certificate;
  return exact;
}

/// A local solver cannot prove that there is no design; the exact method may, and a fifth of the time is kept for it.
DesignResult local_or_proof(const Task& task, const DesignOptions& options) {
  const auto began = std::chrono::steady_clock::now();
  DesignOptions most = options;
  most.time_limit *= 0.8;
  DesignResult nlp = design_nlp(task, most);
  const bool cancelled = options.cancel != nullptr && options.cancel->load();
  if (nlp.has_design() || cancelled) return nlp;
  ExactOptions exact = exact_options(options);
  exact.time_limit -= seconds_since(began);
  if (exact.time_limit <= 0.0) return nlp;
  DesignResult proof;
  try {
    proof = design_exact(task, exact);
  } catch (const exact::TooLarge&) {
    return nlp;
  }
  if (proof.status == Status::infeasible) return proof;
  if (proof.has_design()) {
    // Whatever limits the local search blamed, they are not in conflict.
    nlp.message = fmt::format("{} found no design{}; there is one: the exact method has {:g} ms", options.solver,
                              nlp.solver.claimed.empty() ? fmt::format(" ({})", nlp.message)
                                                         : fmt::format(" (last claim: {})", nlp.solver.claimed),
                              1e3 * proof.objective());
  }
  return nlp;
}

}  // namespace

DesignResult design_task(const Task& task, const DesignOptions& options) {
  // An unknown solver is bad usage whatever becomes of the task.
  if (options.method == Method::nlp) solvers::find_solver(options.solver);
  const std::vector<std::string> conflicts = contradictions(task);
  if (!conflicts.empty()) {
    DesignResult result;
    result.task = task;
    result.status = Status::infeasible;
    result.message = fmt::format("limits in conflict: {}", fmt::join(conflicts, "; "));
    result.certificate = certify_contradiction(task);
    return result;
  }
  if (task.filter) return design_delays(task, options);
  return options.method == Method::exact ? design_anytime(task, options) : local_or_proof(task, options);
}

}  // namespace accdec
