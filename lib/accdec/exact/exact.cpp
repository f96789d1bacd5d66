#include <algorithm>

#include <accdec/exact/exact_run.hpp>
#include <accdec/exact/minimal_conflict.hpp>
#include <accdec/task/convexity.hpp>
#include <accdec/verify.hpp>

// Turns the outcome of the search into a result.

namespace accdec {

void ExactRun::explain(DesignResult& result) const {
  if (result.status == Status::optimal) return;
  const bool stop = stopped();
  if (stop)
    result.stop = cancelled() ? StopReason::interrupted : StopReason::time_limit;
  else if (result.status == Status::feasible && close_enough())
    result.stop = StopReason::gap_reached;
  if (result.status == Status::feasible) {
    result.message = stop             ? "stopped before the proof was complete"
                     : close_enough() ? "stopped at the gap asked for"
                                      : "the limits can be held only to within rounding at anything shorter: whether "
                                        "there is such a design is open";
  } else if (!bench_.designs.best) {
    result.message =
        stop ? "stopped before a design was found"
        : kind_.convex
            ? "no design was found, but none could be excluded either: some limit can be held only to within "
              "rounding; a design may be found with that limit a little wider"
            : "no design was found that holds power, regeneration and the smallest speeds as well, but it is "
              "not proved that there is none";
  }
}

DesignResult ExactRun::conclude() {
  DesignResult result;
  result.task = task_;
  if (done_.infeasible) {
    result.status = Status::infeasible;
    exact::Conflict conflict{search_.proof.conflict, !stopped()};
    if (conflict.limits.empty()) conflict = exact::find_conflict(task_, [this] { return stopped(); });
    result.message = exact::to_message(conflict, task_);
    search_.proof.conflict = conflict.limits;
  } else if (bench_.designs.best) {
    const exact::Candidate& best = *bench_.designs.best;
    result = assess(task_, best.filter, best.delays, false);
    result.lower_bound = std::min(targets_.low(), best.value) * task_.sample_period;
    result.gap = std::max(0.0, (result.objective() - *result.lower_bound) / result.objective());
    if (result.status == Status::feasible && targets_.low() >= best.value * (1.0 - 1e-9))
      result.status = Status::optimal;
  } else {
    result.status = Status::failed;
    result.lower_bound = targets_.low() * task_.sample_period;
  }
  if (!done_.infeasible) explain(result);
  result.solver.method = "exact";
  result.solver.name = "dual simplex", result.solver.version = "accdec";
  if (options_.certificate && search_.proof.target > 0.0) result.certificate = exact::certify(search_.proof, task_);
  return result;
}

DesignResult design_exact(const Task& task, const ExactOptions& options) {
  return ExactRun(task).go_on(options);
}

}  // namespace accdec
