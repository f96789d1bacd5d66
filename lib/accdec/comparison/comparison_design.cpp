#include <algorithm>
#include <chrono>

#include <fmt/format.h>

#include <accdec/batch/row_numbers.hpp>
#include <accdec/comparison/comparison_run.hpp>
#include <accdec/comparison/design_answer.hpp>
#include <accdec/comparison/external_solver.hpp>
#include <accdec/comparison/run_rows.hpp>
#include <accdec/comparison/suite_instances.hpp>
#include <accdec/design.hpp>
#include <accdec/design/anytime.hpp>
#include <accdec/exact/exact.hpp>
#include <accdec/files.hpp>
#include <accdec/instances/instance.hpp>
#include <accdec/solver.hpp>

namespace accdec::comparison {
namespace {

using Clock = std::chrono::steady_clock;
using solvers::Claim;

Claim claim_of(const DesignResult& result) {
  switch (result.status) {
    case Status::optimal: return Claim::solved;
    case Status::infeasible: return Claim::infeasible;
    case Status::feasible: return result.stop == StopReason::time_limit ? Claim::time_limit : Claim::acceptable;
    case Status::failed: return result.stop == StopReason::time_limit ? Claim::time_limit : Claim::failed;
  }
  return Claim::failed;
}

}  // namespace

bool refused_into(batch::Row& row, const std::string& reason) {
  if (reason.empty()) return false;
  row["claim"] = to_string(Claim::refused);
  row["message"] = reason;
  return true;
}

/// The exact method on one core, with its certificate.
void Comparison::exact_into(batch::Row& row, const ScheduledRun& entry, const Task& task) const {
  ExactOptions options;
  options.time_limit = time_limit(entry);
  if (refused_into(row, exact_covers(task) ? "" : "the exact method does not know all limits of this task")) return;
  const auto began = Clock::now();
  std::vector<nlp::Improvement> history;
  options.progress = [&](const ExactProgress& p) {
    const double objective = p.incumbent / task.sample_period;
    if (std::isfinite(objective) && (history.empty() || objective < history.back().objective))
      history.push_back({1, seconds_since(began), objective});
  };
  const DesignResult result = design_exact(task, options);
  row["claim"] = to_string(claim_of(result));
  if (entry.repeat == 0) row["message"] = result.message;
  row["verdict"] = result.has_design() ? "feasible" : "none";
  if (result.has_design()) row["objective"] = batch::number(result.objective() / task.sample_period);
  row["evaluations"] = counts_row({.objective = result.solver.evaluations});
  row["wall_time_s"] = batch::seconds(seconds_since(began));
  row["history"] = thinned(history);
}

/// A solver that knows whole variables gets the whole choice as one problem.
void Comparison::choice_into(batch::Row& row, const ScheduledRun& entry, const ComparisonCase& subject,
                             const Task& task) const {
  const auto started = Clock::now();
  const Competitor& competitor = settings_.solvers[entry.solver];
  instances::Choice choice;
  try {
    choice = choice_of(subject);
  } catch (const std::invalid_argument& reason) {
    refused_into(row, reason.what());
    return;
  }
  const Filter filter = subject.start_filter(entry.start, settings_.seed);
  for (int k = 1; k <= subject.spec().order; ++k) choice.start[static_cast<std::size_t>(k) - 1] = filter.cumulative(k);
  const solvers::Result result = answer_into(row, competitor, choice.problem, choice.start, solver_options(entry));
  if (entry.repeat == 0) row["message"] = result.message;
  if (result.claim == Claim::refused) return;
  row["wall_time_s"] = batch::seconds(result.wall_time);
  row["evaluations"] = counts_row(result.counts);
  row["evaluation_time_s"] = batch::seconds(result.counts.evaluation_time);
  if (!std::all_of(result.x.begin(), result.x.end(), [](double v) { return std::isfinite(v); })) return;
  const auto began = Clock::now();
  const ExternalSolver* program = competitor.program();
  const bool tangents = program && program->external().reads == "mps";
  // The process of this run must not be killed while it judges.
  const double left = kill_after(index_of(entry, entry.repeat)) - seconds_since(started) - 0.5;
  const DesignAnswer answer =
      judged_design(task, choice, result.x, tangents ? replaced_violation_of_tangents : replaced_violation,
                    std::min(judging_time_limit, left));
  row["verification_time_s"] = batch::seconds(seconds_since(began));
  row["verdict"] = answer.design ? "feasible" : answer.whole && answer.in_time ? "infeasible" : "none";
  row["violation"] = batch::rounded(answer.violation, 4);
  if (!answer.in_time) row["claim"] = "not judged";  // the judge's time says nothing of the solver
  if (answer.design) row["objective"] = batch::number(answer.design->objective() / task.sample_period);
  if (entry.repeat == 0 && !answer.remark.empty()) row["message"] = result.message + "; " + answer.remark;
}

void Comparison::design_into(batch::Row& row, const ScheduledRun& entry) const {
  const ComparisonCase subject(cases_[entry.case_index]);
  const Competitor& competitor = settings_.solvers[entry.solver];
  Task task = subject.spec().task;
  task.design.order_min = task.design.order_max = subject.spec().order;
  if (refused_into(row, subject.objection())) return;
  if (competitor.is_exact()) return exact_into(row, entry, task);
  if (competitor.registered().capabilities().integers) return choice_into(row, entry, subject, task);
  DesignOptions options;
  options.method = Method::nlp;
  options.nlp.solver = competitor.solver;
  options.time_limit = options.nlp.options.time_limit = time_limit(entry);
  options.nlp.options.tolerance = settings_.tolerance;
  options.nlp.options.evaluation_limit = settings_.evaluation_limit;
  options.nlp.options.own_budget = false;
  options.nlp.options.native = competitor.native;
  options.nlp.options.seed = settings_.seed + static_cast<std::uint64_t>(entry.start);
  options.nlp.start = subject.start_filter(entry.start, settings_.seed);
  options.nlp.reduced = competitor.wants_reduced(settings_.reduced);
  const auto began = Clock::now();
  std::vector<nlp::Improvement> history;
  options.nlp.improved = [&](double objective, const nlp::Counts& so_far) {
    history.push_back({std::max(so_far.objective, so_far.rows), seconds_since(began) - so_far.verification_time,
                       objective / task.sample_period});
  };
  DesignResult result;
  try {
    result = design_nlp(task, options);
  } catch (const std::invalid_argument& refusal) {
    refused_into(row, refusal.what());
    return;
  }
  // Checking takes longer for solvers that give no multipliers. As with single problems, this is not part of their
  // time.
  const double judging = result.solver.counts.verification_time, wall = seconds_since(began) - judging;
  const bool found = result.status == Status::feasible || result.status == Status::optimal;
  const bool late = wall + judging > time_limit(entry);
  row["claim"] = late ? to_string(solvers::Claim::time_limit) : found ? to_string(solvers::Claim::solved) : "no design";
  if (entry.repeat == 0) row["message"] = result.message;
  row["verdict"] = found ? "feasible" : "none";
  if (found) row["objective"] = batch::number(result.objective() / task.sample_period);
  row["evaluations"] = counts_row(result.solver.counts);
  row["wall_time_s"] = batch::seconds(wall);
  row["evaluation_time_s"] = batch::seconds(result.solver.counts.evaluation_time);
  row["verification_time_s"] = batch::seconds(judging);
  row["history"] = thinned(history);
}

}  // namespace accdec::comparison
