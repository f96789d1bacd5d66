#pragma once

#include <accdec/nlp/evaluator.hpp>
#include <accdec/solvers/solver.hpp>

namespace accdec::solvers {

/// Evaluator limits of the common options.
inline nlp::Evaluator::Limits limits_of(const Options& options) {
  return {options.evaluation_limit, options.time_limit, options.cancel, options.feasibility_tolerance};
}

/// What every adapter does after its library returned: rethrows the problem's exception, turns the evaluator's stop into the claim,
/// takes over the counts, and after a stop replaces the point by the best feasible one seen, if there is one.
inline void conclude(const nlp::Evaluator& evaluator, Result& result) {
  result.counts = evaluator.counts();
  switch (evaluator.stop()) {
    case nlp::Stop::none: return;
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
