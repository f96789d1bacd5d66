#pragma once

#include <string>

#include <fmt/format.h>

#include <accdec/files/memory.hpp>
#include <accdec/nlp/violation.hpp>
#include <accdec/problem.hpp>
#include <accdec/solver.hpp>

namespace accdec::solvers {

/// Evaluator limits of the common options.
inline nlp::Evaluator::Limits limits_of(const Options& options) {
  return {options.evaluation_limit, options.time_limit, options.cancel, options.feasibility_tolerance};
}

/// A message if tables of this many numbers do not fit into half of the available memory; else empty.
inline std::string tables_too_large(double numbers) {
  const double bytes = sizeof(double) * numbers, there = available_memory();
  if (bytes <= 0.5 * there) return "";
  return fmt::format("its dense tables would take {:.3g} GB, {:.3g} GB are free", 1e-9 * bytes, 1e-9 * there);
}

/// Returns the best feasible point seen, if the library ended on its own at a worse one. Worse means that it breaks a
/// row or bound although a feasible point was seen, or that its objective is worse by more than rounding and tolerances
/// explain. NLopt remembers the best point that holds rows to a tenth of the tolerance. So it may return the start even
/// though later points hold within the tolerance.
inline void prefer_best(const nlp::Evaluator& evaluator, Result& result) {
  if (evaluator.best_feasible().empty() || result.x == evaluator.best_feasible()) return;
  const bool broken = nlp::largest_violation(evaluator.problem(), result.x) > evaluator.feasibility_tolerance();
  if (!broken && !nlp::materially_better(evaluator.best_objective(), evaluator.problem().objective(result.x))) return;
  result.x = evaluator.best_feasible();
  result.row_multipliers.clear();
  result.message += broken ? "; ended at a point that breaks a row: the best feasible one seen is returned instead"
                           : "; ended at a worse point than the best feasible one seen, which is returned instead";
}

/// Every adapter calls this after its library returned. It rethrows the problem's exception, turns the evaluator's stop
/// into the claim and takes over the counts. After a stop, or if the library's point is worse, it takes the best
/// feasible point seen.
inline void conclude(const nlp::Evaluator& evaluator, Result& result) {
  result.counts = evaluator.counts();
  result.history = evaluator.history();
  switch (evaluator.stop()) {
    case nlp::Stop::none: return prefer_best(evaluator, result);
    case nlp::Stop::exception: std::rethrow_exception(evaluator.exception());
    case nlp::Stop::invalid_number: result.claim = Claim::invalid_number; break;
    case nlp::Stop::evaluation_limit: result.claim = Claim::evaluation_limit; break;
    case nlp::Stop::time_limit: result.claim = Claim::time_limit; break;
    case nlp::Stop::cancelled: result.claim = Claim::cancelled; break;
  }
  if (!evaluator.best_feasible().empty()) {
    result.x = evaluator.best_feasible();
    result.row_multipliers.clear();
  }
}

}  // namespace accdec::solvers
