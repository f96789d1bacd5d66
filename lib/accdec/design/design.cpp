#include <algorithm>
#include <chrono>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/design/design.hpp>
#include <accdec/exact/exact.hpp>
#include <accdec/task/contradictions.hpp>

namespace accdec {
namespace {

ExactOptions exact_options(const DesignOptions& options) {
  ExactOptions exact;
  exact.time_limit = options.time_limit;
  exact.gap = options.gap;
  exact.cancel = options.cancel;
  exact.certificate = options.certificate;
  if (options.progress) {
    exact.progress = [tell = options.progress](const ExactProgress& p) {
      if (p.incumbent < unlimited) {
        tell(fmt::format("bound {:.3f} ms, best {:.3f} ms, gap {:.1f} %", p.bound * 1e3, p.incumbent * 1e3,
                         100.0 * p.gap));
      } else {
        tell(fmt::format("bound {:.3f} ms, no design yet", p.bound * 1e3));
      }
    };
  }
  return exact;
}

bool has_design(const DesignResult& result) {
  return result.status == Status::optimal || result.status == Status::feasible;
}

/// The bound of one result with the design of another that is shorter.
DesignResult combine(DesignResult design, const DesignResult& bound) {
  design.lower_bound = bound.lower_bound;
  design.certificate = bound.certificate;
  design.message = bound.message;
  design.solver.method = "exact";
  design.solver.name = bound.solver.name + "+" + design.solver.name;
  design.solver.version = bound.solver.version + ", " + design.solver.version;
  design.solver.evaluations += bound.solver.evaluations;
  design.solver.wall_time += bound.solver.wall_time;
  if (design.lower_bound) {
    design.gap = std::max(0.0, (design.objective() - *design.lower_bound) / design.objective());
    if (*design.lower_bound >= design.objective() * (1.0 - 1e-9)) {
      design.status = Status::optimal;
      design.lower_bound = design.objective();
      design.gap = 0.0;
      design.message.clear();
    }
  }
  return design;
}

/// The exact method; where it proves no optimum (limits outside the convex class, time), a nonlinear solver may still
/// know a shorter design than it does.
DesignResult exact_then_local(const Task& task, const DesignOptions& options) {
  const auto began = std::chrono::steady_clock::now();
  // With several corners a proof may take all the time there is; a local solver's design may still be the better one.
  ExactOptions most = exact_options(options);
  if (task.corners.size() > 1) most.time_limit *= 0.9;
  DesignResult exact = design_exact(task, most);
  if (options.certificate && exact.certificate.empty()) {
    // Stopped before anything was proved: a bound nobody can check is none.
    exact.lower_bound.reset();
    exact.gap.reset();
  }
  if (exact.status == Status::optimal || exact.status == Status::infeasible) return exact;
  if (options.gap > 0.0 && exact.gap && *exact.gap <= options.gap) return exact;
  DesignOptions local = options;
  local.time_limit -= std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  const bool cancelled = options.cancel != nullptr && options.cancel->load();
  if (cancelled || local.time_limit <= 0.0) return exact;
  const DesignResult nlp = design_nlp(task, local);
  if (!has_design(nlp) && !has_design(exact)) {
    // Nothing proved and nothing found: the local search at least knows which limits are in each other's way.
    exact.message += "; " + nlp.message;
    return exact;
  }
  if (!has_design(nlp) || (has_design(exact) && exact.objective() <= nlp.objective())) return exact;
  return combine(nlp, exact);
}

/// A local solver cannot prove that there is no design; the exact method may, and a fifth of the time is kept for it.
DesignResult local_or_proof(const Task& task, const DesignOptions& options) {
  const auto began = std::chrono::steady_clock::now();
  DesignOptions most = options;
  most.time_limit *= 0.8;
  DesignResult nlp = design_nlp(task, most);
  const bool cancelled = options.cancel != nullptr && options.cancel->load();
  if (has_design(nlp) || cancelled) return nlp;
  ExactOptions exact = exact_options(options);
  exact.time_limit -= std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  if (exact.time_limit <= 0.0) return nlp;
  const DesignResult proof = design_exact(task, exact);
  if (proof.status == Status::infeasible) return proof;
  if (has_design(proof)) {
    // Whatever limits the local search blamed, they are not in conflict.
    nlp.message = fmt::format("{} found no design{}; there is one: the exact method has {:g} ms", options.solver,
                              nlp.solver.claimed.empty() ? "" : fmt::format(" (last claim: {})", nlp.solver.claimed),
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
    result.certificate = R"({"schema":"accdec.certificate/1","kind":"constant feed"})";
    return result;
  }
  if (task.filter) return design_delays(task, options);
  return options.method == Method::exact ? exact_then_local(task, options) : local_or_proof(task, options);
}

}  // namespace accdec
