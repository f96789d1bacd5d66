#pragma once

#include <algorithm>
#include <cmath>

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
  result.history = evaluator.history();
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

/// Where the library ended on its own at a point that breaks a row or bound although it had seen one that holds all, or at one that is worse
/// than the best seen by more than rounding and tolerances explain: returns that. (NLopt remembers the best point by rows held to a
/// tenth of the tolerance, and may hand back the start although it went on to points that hold within the tolerance.)
inline void prefer_feasible(const nlp::Evaluator& evaluator, double tolerance, Result& result) {
  if (evaluator.best_feasible().empty() || result.x == evaluator.best_feasible()) return;
  const nlp::Problem& problem = evaluator.problem();
  std::vector<double> c(static_cast<std::size_t>(problem.num_rows()));
  problem.rows(result.x, c);
  const auto outside = [&](nlp::Bound b, double v) { return !(v >= b.lower - tolerance && v <= b.upper + tolerance); };
  bool broken = false;
  for (int r = 0; r < problem.num_rows(); ++r) broken = broken || outside(problem.row_bound(r), c[static_cast<std::size_t>(r)]);
  for (int i = 0; i < problem.num_variables(); ++i) {
    broken = broken || outside(problem.variable_bound(i), result.x[static_cast<std::size_t>(i)]);
  }
  constexpr double material = 1e-6;
  const double objective = problem.objective(result.x);
  const bool worse = evaluator.best_objective() < objective - material * std::max(1.0, std::abs(objective));
  if (!broken && !worse) return;
  result.x = evaluator.best_feasible();
  result.row_multipliers.clear();
  result.message += broken ? "; ended at a point that breaks a row: the best feasible one seen is returned instead"
                           : "; ended at a worse point than the best feasible one seen, which is returned instead";
}

}  // namespace accdec::solvers
