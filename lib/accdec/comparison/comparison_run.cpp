#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>
#include <random>
#include <stdexcept>

#include <malloc.h>

#include <fmt/format.h>

#include <accdec/batch/row_numbers.hpp>
#include <accdec/comparison/comparison_data.hpp>
#include <accdec/comparison/comparison_run.hpp>
#include <accdec/comparison/design_answer.hpp>
#include <accdec/design.hpp>
#include <accdec/files.hpp>
#include <accdec/formats/toml_file.hpp>

namespace accdec::comparison {
using Clock = std::chrono::steady_clock;

Comparison::Comparison(ComparisonSettings settings, std::vector<CaseSpec> cases) : settings_(std::move(settings)) {
  if (cases.empty() || settings_.solvers.empty() || settings_.targets.empty() || settings_.starts < 1 ||
      settings_.repeats < 1) {
    throw std::invalid_argument("a comparison needs at least one problem, solver, target, start and repeat");
  }
  for (const Competitor& competitor : settings_.solvers) competitor.registered();
  for (const CaseSpec& spec : cases) ComparisonCase{spec};  // throws its errors now instead of in every run
  cases_ = std::move(cases);
  ::malloc_trim(0);
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
  const std::size_t start = rest % starts;
  rest /= starts;
  const std::size_t repeat = rest / cases_.size();
  run.case_index = rest % cases_.size();
  run.start = static_cast<int>(start);
  run.repeat = static_cast<int>(repeat);
  run.solver = order_of_solvers(run.case_index, start, repeat)[position];
  return run;
}

std::size_t Comparison::index_of(const ScheduledRun& run, int repeat) const {
  const std::size_t solvers = settings_.solvers.size(), starts = static_cast<std::size_t>(settings_.starts);
  const std::size_t r = static_cast<std::size_t>(repeat), start = static_cast<std::size_t>(run.start);
  const std::vector<std::size_t> order = order_of_solvers(run.case_index, start, r);
  const auto position = static_cast<std::size_t>(std::find(order.begin(), order.end(), run.solver) - order.begin());
  return cases_.size() + ((r * cases_.size() + run.case_index) * starts + start) * solvers + position;
}

std::vector<std::size_t> Comparison::order_of_solvers(std::size_t case_index, std::size_t start,
                                                      std::size_t repeat) const {
  std::seed_seq seed{static_cast<std::size_t>(settings_.seed), case_index, start, repeat};
  std::mt19937_64 random(seed);
  std::vector<std::size_t> order(settings_.solvers.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  // Fisher-Yates: std::shuffle may differ between libraries, and the raw data are indexed by this order.
  for (std::size_t left = order.size(); left > 1; --left)
    std::swap(order[left - 1], order[static_cast<std::size_t>(random() % left)]);
  return order;
}

double Comparison::time_limit(const ScheduledRun& run) const {
  if (run.reference) return settings_.reference_time_limit;
  const double own = cases_[run.case_index].time_limit;
  return own > 0.0 ? own : settings_.time_limit;
}

double Comparison::kill_after(std::size_t index) const {
  const ScheduledRun run = at(index);
  const double limit = time_limit(run);
  if (run.reference) return 2.0 * limit + 5.0;
  const double own = limit + settings_.kill_after - settings_.time_limit;
  // A program is killed by itself before. Its process still judges the answer.
  return settings_.solvers[run.solver].program() ? own + judging_time_limit + 5.0 : own;
}

batch::Row Comparison::header() const {
  batch::Row row;
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
  row["solvers"] = batch::Row::array();
  for (const Competitor& competitor : settings_.solvers) {
    const solvers::Solver& solver = competitor.registered();
    const solvers::Capabilities can = solver.capabilities();
    const bool reduced = competitor.wants_reduced(settings_.reduced),
               curvature = can.uses_hessian && !reduced;  // the reduced form has none
    const char* uses = can.linear_only                          ? "coefficients"
                       : curvature                              ? "second derivatives"
                       : can.uses_gradient || can.uses_jacobian ? "first derivatives"
                                                                : "values";
    batch::Row entry;
    entry["name"] = competitor.name;
    entry["solver"] = competitor.solver;
    entry["library"] = solver.library_version();
    // Nobody knows that of a program.
    entry["uses"] = competitor.program() ? "" : uses;
    entry["search"] = competitor.program() ? "" : can.global ? "global" : "local";
    entry["form"] = reduced ? "reduced" : "sparse";
    entry["settings"] = solver.settings();
    if (!competitor.native.empty()) entry["options"] = competitor.native;
    row["solvers"].push_back(std::move(entry));
  }
  return row;
}

batch::Row Comparison::run(std::size_t index) const {
  const ScheduledRun entry = at(index);
  return entry.reference ? reference_row(entry) : run_row(entry);
}

std::string Comparison::key(std::size_t index) const {
  const ScheduledRun entry = at(index);
  const CaseSpec& spec = cases_[entry.case_index];
  if (spec.identity.empty()) return "";
  const ComparisonSettings& s = settings_;
  if (entry.reference) {
    return toml_input::hash_of(fmt::format("problem\n{}\n{}\n{}\n{} {}", spec.identity, spec.name, spec.family,
                                           s.reference_time_limit, s.time_limit));
  }
  const Competitor& competitor = s.solvers[entry.solver];
  std::string text =
      fmt::format("run\n{}\n{} {}", spec.identity, competitor.solver, competitor.wants_reduced(s.reduced));
  for (const auto& [name, value] : competitor.native) text += fmt::format(" {}={}", name, value);
  if (!competitor.state.empty()) text += "\n" + competitor.state;
  text += fmt::format("\n{} {} {} {} {} {} {} {}", entry.start, s.seed, entry.repeat, time_limit(entry),
                      kill_after(index), s.evaluation_limit, s.tolerance, s.feasibility);
  return toml_input::hash_of(text);
}

batch::Row Comparison::beginning_of_run(const ScheduledRun& entry) const {
  batch::Row row;
  row["record"] = "run";
  row["index"] = index_of(entry, entry.repeat);
  row["key"] = key(index_of(entry, entry.repeat));
  row["case"] = entry.case_index;
  row["start"] = entry.start;
  row["solver"] = settings_.solvers[entry.solver].name;
  row["repeat"] = entry.repeat;
  return row;
}

batch::Row Comparison::beginning_of_reference(std::size_t case_index, const ComparisonCase& subject) const {
  const CaseSpec& spec = subject.spec();
  batch::Row row;
  row["record"] = "problem";
  row["index"] = case_index;
  row["key"] = key(case_index);
  row["case"] = case_index;
  describe(row, "question", subject);
  row["variables"] = subject.variables();
  row["rows"] = subject.rows();
  row["time_limit_s"] = spec.time_limit > 0.0 ? spec.time_limit : settings_.time_limit;
  row["expected"] = to_string(spec.expected);
  return row;
}

batch::Row Comparison::reference_row(const ScheduledRun& entry) const {
  const ComparisonCase subject(cases_[entry.case_index]);
  batch::Row row = beginning_of_reference(entry.case_index, subject);
  const auto began = Clock::now();
  Reference reference;
  try {
    reference = reference_of(subject, settings_.reference_time_limit);
  } catch (const std::exception& error) {
    reference = {Reference::Proof::bound, 0.0, nlp::infinity, fmt::format("error: {}", error.what())};
  }
  row["proof"] = to_string(reference.proof);
  row["lower"] = batch::number(reference.lower);
  row["upper"] = batch::number(reference.upper);
  row["method"] = reference.method;
  row["work"] = reference.work;
  row["reference_time_s"] = batch::seconds(seconds_since(began));
  return row;
}

batch::Row Comparison::run_row(const ScheduledRun& entry) const {
  batch::Row row = beginning_of_run(entry);
  row["claim"] = "error";
  row["verdict"] = "none";
  try {
    settings_.solvers[entry.solver].warm_up();
    cases_[entry.case_index].question == Question::design ? design_into(row, entry) : solve_into(row, entry);
  } catch (const std::exception& error) {
    row["message"] = error.what();
  }
  return row;
}

batch::Row Comparison::lost(std::size_t index, const std::string& reason) const {
  const ScheduledRun entry = at(index);
  if (entry.reference) {
    batch::Row row = beginning_of_reference(entry.case_index, ComparisonCase(cases_[entry.case_index]));
    row["proof"] = to_string(Reference::Proof::bound);
    row["lower"] = 0.0;
    row["upper"] = nullptr;
    row["method"] = fmt::format("none: {}", reason);
    return row;
  }
  batch::Row row = beginning_of_run(entry);
  row["claim"] = reason.starts_with("given up") ? claim_killed : claim_crashed;
  row["verdict"] = "none";
  row["message"] = reason;
  return row;
}

}  // namespace accdec::comparison
