#include <accdec/study/comparison_run.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include <accdec/design/design.hpp>
#include <accdec/solvers/solver.hpp>

namespace accdec::study {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point then) { return std::chrono::duration<double>(Clock::now() - then).count(); }

Row rounded(double x, int digits) {
  if (!std::isfinite(x)) return nullptr;
  return std::stod(fmt::format("{:.{}g}", x, digits));
}
Row number(double x) { return rounded(x, 12); }
Row seconds(double x) { return rounded(x, 5); }

/// Improvements that matter: the first, the last, and those that leave at most 0.7 of the distance to the last that the one before left.
Row thinned(const std::vector<nlp::Improvement>& history) {
  Row list = Row::array();
  double left = nlp::infinity;
  for (std::size_t i = 0; i < history.size(); ++i) {
    const double now = history[i].objective - history.back().objective;
    if (now > 0.7 * left && i + 1 < history.size()) continue;
    left = now;
    list.push_back(Row::array({history[i].evaluations, seconds(history[i].time), number(history[i].objective)}));
  }
  return list;
}

/// Largest violation of any bound or row; infinite where something is not finite.
double violation_of(const nlp::Problem& problem, const std::vector<double>& x, double& objective) {
  std::vector<double> c(static_cast<std::size_t>(problem.num_rows()));
  objective = problem.objective(x);
  problem.rows(x, c);
  double worst = std::isfinite(objective) ? 0.0 : nlp::infinity;
  const auto judge = [&](nlp::Bound b, double v) { worst = std::isfinite(v) ? std::max({worst, b.lower - v, v - b.upper}) : nlp::infinity; };
  for (int r = 0; r < problem.num_rows(); ++r) judge(problem.row_bound(r), c[static_cast<std::size_t>(r)]);
  for (int i = 0; i < problem.num_variables(); ++i) judge(problem.variable_bound(i), x[static_cast<std::size_t>(i)]);
  return worst;
}

}  // namespace

Comparison::Comparison(ComparisonSettings settings, std::vector<CaseSpec> cases) : settings_(std::move(settings)) {
  if (cases.empty() || settings_.solvers.empty() || settings_.targets.empty() || settings_.starts < 1 || settings_.repeats < 1) {
    throw std::invalid_argument("a comparison needs at least one problem, solver, target, start and repeat");
  }
  for (const std::string& name : settings_.solvers) solvers::find_solver(name);
  for (CaseSpec& spec : cases) cases_.push_back(std::make_unique<ComparisonCase>(std::move(spec)));
}

ScheduledRun Comparison::at(std::size_t index) const {
  if (index >= size()) throw std::out_of_range(fmt::format("entry {} of a comparison of {}", index, size()));
  ScheduledRun run;
  if (index < cases_.size()) {
    run.reference = true;
    run.case_index = index;
    return run;
  }
  std::size_t rest = index - cases_.size();
  const std::size_t solvers = settings_.solvers.size(), starts = static_cast<std::size_t>(settings_.starts);
  const std::size_t position = rest % solvers;
  rest /= solvers;
  run.start = static_cast<int>(rest % starts);
  rest /= starts;
  run.case_index = rest % cases_.size();
  run.repeat = static_cast<int>(rest / cases_.size());
  run.solver = (position + run.case_index + rest / cases_.size() + static_cast<std::size_t>(run.start)) % solvers;
  return run;
}

std::size_t Comparison::index_of(const ScheduledRun& run, int repeat) const {
  const std::size_t solvers = settings_.solvers.size(), starts = static_cast<std::size_t>(settings_.starts), r = static_cast<std::size_t>(repeat);
  const std::size_t shift = (run.case_index + r + static_cast<std::size_t>(run.start)) % solvers;
  const std::size_t position = (run.solver + solvers - shift) % solvers;
  return cases_.size() + ((r * cases_.size() + run.case_index) * starts + static_cast<std::size_t>(run.start)) * solvers + position;
}

double Comparison::time_limit(const ScheduledRun& run) const {
  if (run.reference) return settings_.reference_time_limit;
  const double own = cases_[run.case_index]->spec().time_limit;
  return own > 0.0 ? own : settings_.time_limit;
}

double Comparison::kill_after(std::size_t index) const {
  const ScheduledRun run = at(index);
  const double limit = time_limit(run);
  return run.reference ? 2.0 * limit + 5.0 : limit + settings_.kill_after - settings_.time_limit;
}

bool Comparison::wants_reduced(const std::string& solver) const {
  const solvers::Capabilities can = solvers::find_solver(solver).capabilities();
  return !can.equality_rows || can.needs_finite_bounds || std::find(settings_.reduced.begin(), settings_.reduced.end(), solver) != settings_.reduced.end();
}

Row Comparison::header() const {
  Row row;
  row["record"] = "comparison";
  row["schema"] = "accdec.comparison/1";
  row["title"] = settings_.title;
  row["notes"] = settings_.notes;
  row["starts"] = settings_.starts;
  row["repeats"] = settings_.repeats;
  row["seed"] = settings_.seed;
  row["time_limit_s"] = settings_.time_limit;
  row["kill_after_s"] = settings_.kill_after;
  row["evaluation_limit"] = settings_.evaluation_limit;
  row["tolerance"] = settings_.tolerance;
  row["feasibility"] = settings_.feasibility;
  row["accuracy"] = settings_.accuracy;
  row["targets"] = settings_.targets;
  row["solvers"] = Row::array();
  for (const std::string& name : settings_.solvers) {
    const solvers::Solver& solver = solvers::find_solver(name);
    const solvers::Capabilities can = solver.capabilities();
    const char* uses = can.linear_only ? "coefficients" : can.uses_hessian ? "second derivatives" : can.uses_gradient || can.uses_jacobian ? "first derivatives" : "values";
    Row entry;
    entry["name"] = name;
    entry["library"] = solver.library_version();
    entry["uses"] = uses;
    entry["search"] = can.global ? "global" : "local";
    entry["form"] = wants_reduced(name) ? "reduced" : "sparse";
    row["solvers"].push_back(std::move(entry));
  }
  return row;
}

Row Comparison::run(std::size_t index) const {
  const ScheduledRun entry = at(index);
  return entry.reference ? reference_row(entry) : run_row(entry);
}

Row Comparison::beginning(const ScheduledRun& entry) const {
  Row row;
  row["record"] = entry.reference ? "problem" : "run";
  row["index"] = entry.reference ? entry.case_index : index_of(entry, entry.repeat);
  row["case"] = entry.case_index;
  if (entry.reference) {
    const ComparisonCase& subject = *cases_[entry.case_index];
    const CaseSpec& spec = subject.spec();
    row["problem"] = spec.name;
    row["family"] = spec.family;
    row["question"] = to_string(spec.question);
    row["size"] = spec.size;
    row["order"] = spec.order;
    row["variables"] = subject.variables();
    row["rows"] = subject.rows();
    row["time_limit_s"] = spec.time_limit > 0.0 ? spec.time_limit : settings_.time_limit;
    row["expected"] = spec.infeasible ? "infeasible" : "feasible";
  } else {
    row["start"] = entry.start;
    row["solver"] = settings_.solvers[entry.solver];
    row["repeat"] = entry.repeat;
  }
  return row;
}

Row Comparison::reference_row(const ScheduledRun& entry) const {
  const ComparisonCase& subject = *cases_[entry.case_index];
  Row row = beginning(entry);
  const auto began = Clock::now();
  Reference reference;
  try {
    reference = reference_of(subject, settings_.reference_time_limit);
  } catch (const std::exception& error) {
    reference = {Reference::Proof::bound, 0.0, nlp::infinity, fmt::format("error: {}", error.what())};
  }
  row["proof"] = to_string(reference.proof);
  row["lower"] = number(reference.lower);
  row["upper"] = number(reference.upper);
  row["method"] = reference.method;
  row["reference_time_s"] = seconds(seconds_since(began));
  return row;
}

Row Comparison::run_row(const ScheduledRun& entry) const {
  Row row = beginning(entry);
  row["claim"] = "error";
  row["verdict"] = "none";
  try {
    cases_[entry.case_index]->spec().question == Question::design ? design_into(row, entry) : solve_into(row, entry);
  } catch (const std::exception& error) {
    row["message"] = error.what();
  }
  return row;
}

void Comparison::solve_into(Row& row, const ScheduledRun& entry) const {
  const ComparisonCase& subject = *cases_[entry.case_index];
  const solvers::Solver& solver = solvers::find_solver(settings_.solvers[entry.solver]);
  const bool reduced = wants_reduced(solver.name());
  solvers::Options options;
  options.tolerance = settings_.tolerance;
  options.feasibility_tolerance = settings_.feasibility;
  options.time_limit = time_limit(entry);
  options.evaluation_limit = settings_.evaluation_limit;
  options.seed = settings_.seed + static_cast<std::uint64_t>(entry.start);
  const std::vector<double> start = subject.start(reduced, entry.start, settings_.seed);
  const auto began = Clock::now();
  const solvers::Result result = solver.solve(*subject.problem(reduced), start, options);
  const double total = seconds_since(began);

  row["claim"] = to_string(result.claim);
  row["message"] = result.message;
  if (result.claim == solvers::Claim::refused) return;
  // Rows of the reduced form are the limits themselves: whatever form a solver had, its answer is judged by these.
  double objective = 0.0;
  const double violation = violation_of(*subject.problem(true), subject.to_reduced(reduced, result.x), objective);
  solvers::Verdict verdict = result.verification.verdict;
  if (!std::isfinite(violation)) verdict = solvers::Verdict::none;
  else if (violation > settings_.feasibility) verdict = solvers::Verdict::infeasible;
  else if (verdict != solvers::Verdict::optimal) verdict = solvers::Verdict::feasible;
  row["verdict"] = to_string(verdict);
  row["objective"] = number(objective);
  row["claimed_objective"] = number(result.claimed_objective);
  row["violation"] = rounded(violation, 4);
  row["worst"] = result.verification.worst;
  row["stationarity"] = rounded(result.verification.stationarity, 4);
  row["complementarity"] = rounded(result.verification.complementarity, 4);
  const solvers::Counts& n = result.counts;
  row["evaluations"] = {{"objective", n.objective}, {"gradient", n.gradient}, {"rows", n.rows}, {"jacobian", n.jacobian}, {"hessian", n.hessian}};
  row["wall_time_s"] = seconds(result.wall_time);
  row["evaluation_time_s"] = seconds(n.evaluation_time);
  row["verification_time_s"] = seconds(total - result.wall_time);
  if (entry.repeat == 0) {
    row["history"] = thinned(result.history);
  } else {  // repeats are for timing: what the first says need not be said again
    for (const char* key : {"message", "claimed_objective", "worst", "stationarity", "complementarity"}) row.erase(key);
  }
}

void Comparison::design_into(Row& row, const ScheduledRun& entry) const {
  const CaseSpec& spec = cases_[entry.case_index]->spec();
  Task task = spec.task;
  task.design.order_min = task.design.order_max = spec.order;
  DesignOptions options;
  options.method = Method::nlp;
  options.solver = settings_.solvers[entry.solver];
  options.time_limit = options.solver_options.time_limit = time_limit(entry);
  options.solver_options.evaluation_limit = settings_.evaluation_limit;
  options.solver_options.seed = settings_.seed + static_cast<std::uint64_t>(entry.start);
  const auto began = Clock::now();
  DesignResult result;
  try {
    result = design_nlp(task, options);
  } catch (const std::invalid_argument& refusal) {
    row["claim"] = to_string(solvers::Claim::refused);
    row["message"] = refusal.what();
    return;
  }
  const double wall = seconds_since(began);
  const bool found = result.status == Status::feasible || result.status == Status::optimal;
  row["claim"] = found ? "solved" : wall > time_limit(entry) ? "time limit" : "no design";
  row["message"] = result.message;
  row["verdict"] = found ? "feasible" : "none";
  if (found) row["objective"] = number(result.cycle_time / task.sample_period);
  row["evaluations"] = {{"objective", result.solver.evaluations}};
  row["wall_time_s"] = seconds(wall);
  if (entry.repeat == 0 && found) row["history"] = Row::array({Row::array({result.solver.evaluations, seconds(wall), row["objective"]})});
}

Row Comparison::lost(std::size_t index, const std::string& reason) const {
  const ScheduledRun entry = at(index);
  Row row = beginning(entry);
  if (entry.reference) {
    row["proof"] = to_string(Reference::Proof::bound);
    row["lower"] = 0.0;
    row["upper"] = nullptr;
    row["method"] = fmt::format("none: {}", reason);
    return row;
  }
  row["claim"] = reason.starts_with("given up") ? "killed" : "crashed";
  row["verdict"] = "none";
  row["message"] = reason;
  return row;
}

bool worth_repeating(const Row& first) {
  const std::string claim = first.value("claim", "");
  return claim != "refused" && claim != "killed" && claim != "crashed" && claim != "error" && claim != "time limit";
}

}  // namespace accdec::study
