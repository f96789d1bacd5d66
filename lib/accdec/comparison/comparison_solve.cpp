#include <algorithm>
#include <chrono>
#include <cmath>

#include <fmt/format.h>

#include <accdec/batch/row_numbers.hpp>
#include <accdec/comparison/comparison_data.hpp>
#include <accdec/comparison/comparison_run.hpp>
#include <accdec/comparison/design_answer.hpp>
#include <accdec/comparison/external_solver.hpp>
#include <accdec/comparison/recorded_problem.hpp>
#include <accdec/comparison/run_rows.hpp>
#include <accdec/design/formulation.hpp>
#include <accdec/files.hpp>
#include <accdec/nlp/violation.hpp>
#include <accdec/solver.hpp>

namespace accdec::comparison {
namespace {

using Clock = std::chrono::steady_clock;

/// Largest violation of any bound or row; infinite where something is not finite.
///
/// A margin's sigma only bounds the errors of its taps. So the point is judged with the sigma that these need, if its
/// own is smaller. How much smaller is a violation, relative to it, unless solvers' tolerances explain it.
double violation_of(const nlp::Problem& problem, std::vector<double> x, double& objective) {
  double shortfall = 0.0;
  if (const auto* margin = dynamic_cast<const MarginProblem*>(&problem)) {
    double& sigma = x[static_cast<std::size_t>(margin->sigma())];
    const double needed = margin->least_sigma(x);
    if (sigma < needed) {
      shortfall = (needed - sigma) / std::max(1.0, needed);
      sigma = needed;
    }
  }
  objective = problem.objective(x);
  const double broken = std::isfinite(objective) ? nlp::largest_violation(problem, x) : nlp::infinity;
  return shortfall > replaced_violation ? std::max(broken, shortfall) : broken;
}

}  // namespace

batch::Row thinned(const std::vector<nlp::Improvement>& history) {
  batch::Row list = batch::Row::array();
  double left = nlp::infinity;
  for (std::size_t i = 0; i < history.size(); ++i) {
    const double now = history[i].objective - history.back().objective;
    if (now > 0.9 * left && i + 1 < history.size()) continue;
    left = now;
    list.push_back(batch::Row::array(
        {history[i].evaluations, batch::seconds(history[i].time), batch::number(history[i].objective)}));
  }
  return list;
}

batch::Row counts_row(const nlp::Counts& n) {
  return {{"objective", n.objective},
          {"gradient", n.gradient},
          {"rows", n.rows},
          {"jacobian", n.jacobian},
          {"hessian", n.hessian}};
}

solvers::Result answer_into(batch::Row& row, const Competitor& competitor, const nlp::Problem& problem,
                            std::span<const double> start, const solvers::Options& options) {
  const ExternalSolver* program = competitor.program();
  ProgramEnd end;
  solvers::Result result =
      program
          ? ExternalSolver(program->external(), [&](const ProgramEnd& e) { end = e; }).solve(problem, start, options)
          : competitor.registered().solve(problem, start, options);
  row["claim"] = end.crashed ? claim_crashed : to_string(result.claim);
  if (end.crashed || end.killed) row["ended"] = end.crashed ? claim_crashed : claim_killed;
  if (end.late) row["late_claim"] = to_string(*end.late);
  return result;
}

solvers::Options Comparison::solver_options(const ScheduledRun& entry) const {
  solvers::Options options;
  options.tolerance = settings_.tolerance;
  options.feasibility_tolerance = settings_.feasibility;
  options.time_limit = time_limit(entry);
  options.evaluation_limit = settings_.evaluation_limit;
  options.own_budget = false;
  options.native = settings_.solvers[entry.solver].native;
  options.seed = settings_.seed + static_cast<std::uint64_t>(entry.start);
  return options;
}

void Comparison::solve_into(batch::Row& row, const ScheduledRun& entry) const {
  const ComparisonCase subject(cases_[entry.case_index]);
  const Competitor& competitor = settings_.solvers[entry.solver];
  const char* exact = "the exact method takes part in designs; elsewhere it gives the references";
  if (refused_into(row, competitor.is_exact() ? exact : subject.objection())) return;
  const bool reduced = competitor.wants_reduced(settings_.reduced);
  const solvers::Options options = solver_options(entry);
  const std::vector<double> start = subject.start(reduced, entry.start, settings_.seed);
  // Rows of the reduced form are the limits themselves. For every form, the answer and the points met on the way are
  // judged by these rows. For a solver of the reduced form, its evaluator does this during the run.
  const auto judged = [&](const std::vector<double>& x, double& objective) {
    return violation_of(*subject.problem(true), subject.to_reduced(reduced, x), objective);
  };
  RecordedProblem recorded(*subject.problem(reduced), [&](const std::vector<double>& x) {
    double objective = 0.0;
    return judged(x, objective) <= settings_.feasibility ? objective : nlp::infinity;
  });
  const nlp::Problem& problem = reduced ? *subject.problem(true) : static_cast<const nlp::Problem&>(recorded);
  const auto began = Clock::now();
  const solvers::Result result = answer_into(row, competitor, problem, start, options);
  const auto& history = reduced ? result.history : recorded.history();
  row["message"] = result.message;
  if (result.claim == solvers::Claim::refused) return;
  double objective = 0.0;
  double violation = judged(result.x, objective);
  solvers::Verdict verdict = result.verification.verdict;
  // As for solvers of the reduced form: if the solver ends where a row is broken, or at a worse point than before, its
  // answer is its best point.
  const bool ends_worse =
      !(violation <= settings_.feasibility) || nlp::materially_better(recorded.best_objective(), objective);
  if (!reduced && !recorded.best().empty() && ends_worse) {
    violation = judged(recorded.best(), objective);
    verdict = solvers::Verdict::feasible;
  }
  if (!std::isfinite(violation))
    verdict = solvers::Verdict::none;
  else if (violation > settings_.feasibility)
    verdict = solvers::Verdict::infeasible;
  else if (verdict != solvers::Verdict::optimal)
    verdict = solvers::Verdict::feasible;
  row["verdict"] = to_string(verdict);
  row["objective"] = batch::number(objective);
  row["claimed_objective"] = batch::number(result.claimed_objective);
  row["violation"] = batch::rounded(violation, 4);
  row["worst"] = result.verification.worst;
  row["stationarity"] = batch::rounded(result.verification.stationarity, 4);
  row["complementarity"] = batch::rounded(result.verification.complementarity, 4);
  row["evaluations"] = counts_row(result.counts);
  row["wall_time_s"] = batch::seconds(result.wall_time);
  row["evaluation_time_s"] = batch::seconds(result.counts.evaluation_time);
  row["verification_time_s"] = batch::seconds(seconds_since(began) - result.wall_time);
  row["history"] = thinned(history);
  if (entry.repeat > 0) {  // this is recorded only for the first repeat
    for (const char* key : {"message", "claimed_objective", "worst", "stationarity", "complementarity"}) row.erase(key);
  }
}

}  // namespace accdec::comparison
