#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>

#include <fmt/format.h>

#include <accdec/comparison/comparison_data.hpp>

namespace accdec::comparison {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

double number_in(const batch::Row& row, const char* key, double missing = nan) {
  const auto found = row.find(key);
  return found != row.end() && found->is_number() ? found->get<double>() : missing;
}

std::string text(const batch::Row& row, const char* key) {
  const auto found = row.find(key);
  return found != row.end() && found->is_string() ? found->get<std::string>() : "";
}

/// @throws std::invalid_argument  if it is neither a number nor null
void require_number(const batch::Row& row, const char* key) {
  const auto found = row.find(key);
  if (found != row.end() && !found->is_number() && !found->is_null())
    throw std::invalid_argument(fmt::format("`{}` must be a number or null", key));
}

/// Asks for all that is read of a run later, so that a wrong value is told with its line.
void check_run(const batch::Row& row) {
  for (const char* key : {"objective", "violation", "wall_time_s"}) require_number(row, key);
  for (const char* key : {"claim", "verdict", "solver"}) {
    if (!row.at(key).is_string()) throw std::invalid_argument(fmt::format("`{}` must be a word", key));
  }
  if (!row.at("repeat").is_number()) throw std::invalid_argument("`repeat` must be a number");
  const auto history = row.find("history");
  for (const batch::Row& step : history != row.end() ? *history : batch::Row::array()) {
    const bool triple = step.is_array() && step.size() == 3;
    if (!triple || !std::all_of(step.begin(), step.end(), [](const batch::Row& x) { return x.is_number(); }))
      throw std::invalid_argument("`history` must hold lists of three numbers");
  }
}

ComparedCase case_of(const batch::Row& row) {
  for (const char* key : {"lower", "upper"}) require_number(row, key);
  ComparedCase c;
  c.problem = row.at("problem");
  c.family = row.at("family");
  c.question = row.at("question");
  c.asks = text(row, "asks");
  c.size = row.at("size");
  c.order = row.at("order");
  c.variables = row.at("variables");
  c.rows = row.at("rows");
  c.method = row.at("method");
  c.time_limit = number_in(row, "time_limit_s", 0.0);
  c.expected = row.at("expected");
  if (const auto work = row.find("work"); work != row.end()) c.work = work->get<long>();
  c.proof = row.at("proof");
  c.infeasible = c.proof == "infeasible proved";
  c.lower = c.infeasible ? nan : number_in(row, "lower", -infinite);
  c.reference = c.proof == "proved" ? number_in(row, "upper") : nan;
  return c;
}

bool found_feasible(const batch::Row& run) {
  return run.at("verdict") == "optimal" || run.at("verdict") == "feasible";
}

class Reader {
 public:
  explicit Reader(const std::vector<std::string>& lines) {
    for (std::size_t i = 0; i < lines.size(); ++i) {
      try {
        take(batch::Row::parse(lines[i]));
      } catch (const nlohmann::json::exception& error) {
        throw std::invalid_argument(fmt::format("line {}: not a record of a comparison ({})", i + 1, error.what()));
      } catch (const std::invalid_argument& error) {
        throw std::invalid_argument(fmt::format("line {}: {}", i + 1, error.what()));
      }
    }
    if (data_.header.is_null()) throw std::invalid_argument("no header: not the raw data of a comparison");
    if (data_.cases.empty()) throw std::invalid_argument("no problems in the raw data");
  }

  ComparisonData read() {
    settle_references();
    data_.attempts.resize(data_.cases.size() * static_cast<std::size_t>(data_.starts) * data_.solvers.size());
    std::vector<std::vector<const batch::Row*>> repeats(data_.attempts.size());
    for (const batch::Row& run : runs_) repeats[index_of(run)].push_back(&run);
    for (std::size_t i = 0; i < repeats.size(); ++i) {
      std::sort(repeats[i].begin(), repeats[i].end(), [](const batch::Row* a, const batch::Row* b) {
        return a->at("repeat").get<int>() < b->at("repeat").get<int>();
      });
      fill(data_.attempts[i], repeats[i],
           data_.cases[i / data_.solvers.size() / static_cast<std::size_t>(data_.starts)]);
    }
    return std::move(data_);
  }

 private:
  void take(batch::Row row) {
    const std::string record = row.at("record");
    if (record == "comparison") {
      if (row.at("schema") != "accdec.comparison/1") throw std::invalid_argument("unknown schema");
      for (const batch::Row& solver : row.at("solvers")) {
        const std::string name = solver.at("name"), algorithm = solver.value("solver", name);
        if (name == algorithm || name.starts_with(algorithm + "/")) data_.plain.push_back(data_.solvers.size());
        solver_index_[name] = data_.solvers.size();
        data_.solvers.push_back(name);
        data_.algorithms.push_back(algorithm);
      }
      data_.targets = row.at("targets").get<std::vector<double>>();
      data_.starts = row.at("starts");
      data_.repeats = row.at("repeats");
      data_.accuracy = row.at("accuracy");
      data_.header = std::move(row);
    } else if (record == "problem") {
      const std::size_t index = row.at("case");
      if (row.at("index") != index) throw std::invalid_argument(fmt::format("case {} has another index", index));
      if (index >= data_.cases.size()) data_.cases.resize(index + 1);
      data_.cases[index] = case_of(row);
    } else if (record == "run") {
      check_run(row);
      runs_.push_back(std::move(row));
    } else if (record == "session") {
      data_.session = std::move(row);
    } else {
      throw std::invalid_argument(fmt::format("unknown record \"{}\"", record));
    }
  }

  std::size_t index_of(const batch::Row& run) const {
    const std::size_t c = run.at("case"), start = run.at("start");
    const auto solver = solver_index_.find(run.at("solver").get<std::string>());
    if (c >= data_.cases.size() || static_cast<int>(start) >= data_.starts || solver == solver_index_.end()) {
      throw std::invalid_argument("a run of no problem, start or solver of this comparison");
    }
    return (c * static_cast<std::size_t>(data_.starts) + start) * data_.solvers.size() + solver->second;
  }

  double allowed(double reference) const { return data_.accuracy * std::max(1.0, std::abs(reference)); }

  /// If the optimum is not proved, the best verified answer of any solver is the reference. No answer may contradict a
  /// proof.
  void settle_references() {
    std::vector<double> best(data_.cases.size(), infinite);
    std::vector<std::string> by(data_.cases.size());
    for (const batch::Row& run : runs_) {
      const std::size_t c = index_of(run) / data_.solvers.size() / static_cast<std::size_t>(data_.starts);
      if (!found_feasible(run) || !(number_in(run, "objective", infinite) < best[c])) continue;
      best[c] = number_in(run, "objective");
      by[c] = run.at("solver");
    }
    const auto contradict = [&](const ComparedCase& c, const std::string& what) {
      data_.contradictions.push_back(fmt::format("{} (size {}): {}", c.problem, c.size, what));
    };
    for (std::size_t i = 0; i < best.size(); ++i) {
      ComparedCase& c = data_.cases[i];
      if (c.infeasible && best[i] < infinite)
        contradict(c, fmt::format("proved infeasible, but {} has a feasible point", by[i]));
      if (c.expected == "infeasible" && !c.infeasible && best[i] < infinite)
        contradict(c, "the suite says infeasible, but a feasible point is known");
      if (c.expected == "feasible" && c.infeasible)
        contradict(c, "the suite says feasible, but it is proved infeasible");
      if (c.infeasible) continue;
      if (best[i] < c.lower - allowed(c.lower))
        contradict(c, fmt::format("{} is below the proved bound {:g}: {:g}", by[i], c.lower, best[i]));
      if (!std::isnan(c.reference)) continue;
      if (best[i] == infinite) {
        c.proof = "unknown";
        continue;
      }
      c.reference = best[i];
      const bool closed = best[i] - c.lower <= allowed(best[i]);
      c.proof = closed ? "proved" : "best known";
      c.method = closed ? fmt::format("{} reaches the proved bound ({})", by[i], c.method)
                        : fmt::format("{}; bound {:g} ({})", by[i], c.lower, c.method);
    }
  }

  struct Outcome {
    Judgement judgement = Judgement::none;
    bool success = false;
    double gap = nan;
  };

  Outcome judged(const batch::Row& row, const ComparedCase& c) const {
    const std::string claim = row.at("claim"), verdict = row.at("verdict");
    if (c.infeasible)
      return {Judgement::impossible, claim == "infeasible", nan};  // "no design" only means that none was found
    Outcome o;
    const bool feasible = found_feasible(row);
    if (feasible) o.gap = (number_in(row, "objective") - c.reference) / std::max(1.0, std::abs(c.reference));
    o.success = feasible && o.gap <= data_.accuracy;
    o.judgement = o.success              ? Judgement::reached
                  : verdict == "optimal" ? Judgement::stationary
                  : feasible             ? Judgement::feasible
                  : verdict == "none"    ? Judgement::none
                                         : Judgement::violates;
    return o;
  }

  void fill(Attempt& a, const std::vector<const batch::Row*>& repeats, const ComparedCase& c) const {
    a.objective = a.gap = a.violation = nan;
    a.target_time.assign(data_.targets.size(), infinite);
    a.target_evaluations.assign(data_.targets.size(), infinite);
    if (c.infeasible) a.judgement = Judgement::impossible;
    if (repeats.empty()) return;
    std::vector<Outcome> outcomes;
    std::vector<double> costs;
    for (const batch::Row* row : repeats) {
      outcomes.push_back(judged(*row, c));
      const double t = number_in(*row, "wall_time_s");
      if (std::isfinite(t)) a.times.push_back(t);
      costs.push_back(outcomes.back().success && std::isfinite(t) ? std::max(t, 1e-9) : infinite);
      a.successes += outcomes.back().success ? 1 : 0;
    }
    a.time = quartiles(a.times);
    a.end_cost = quartiles(costs).median;
    a.success = 2 * a.successes > repeats.size();
    const auto first =
        std::find_if(outcomes.begin(), outcomes.end(), [&](const Outcome& o) { return o.success == a.success; });
    take_single(a, *repeats[static_cast<std::size_t>(first - outcomes.begin())], *first, c);
    a.message = text(*repeats.front(), "message");
    if (c.infeasible || std::isnan(c.reference)) return;
    for (std::size_t t = 0; t < data_.targets.size(); ++t) {
      const Meeting meeting = met(repeats, outcomes, c.reference, data_.targets[t], false);
      a.target_time[t] = meeting.time;
      a.target_evaluations[t] = meeting.evaluations;
    }
    a.accuracy_cost = met(repeats, outcomes, c.reference, data_.accuracy, true).time;
  }

  static double evaluations_of(const batch::Row& row) {
    const auto n = row.find("evaluations");
    return n == row.end() ? 0.0 : std::max(number_in(*n, "objective", 0.0), number_in(*n, "rows", 0.0));
  }

  static void take_single(Attempt& a, const batch::Row& row, const Outcome& outcome, const ComparedCase& c) {
    a.judgement = outcome.judgement;
    a.gap = outcome.gap;
    a.claim = row.at("claim");
    if (const std::string late = text(row, "late_claim"); a.claim == "time limit" && !late.empty()) {
      a.claim = late;
      if (!wrong_claim(c, a)) a.claim = "time limit";
    }
    a.accepted = a.claim != "refused";
    a.lost = lost(a.claim) || row.contains("ended");
    a.objective = number_in(row, "objective");
    a.violation = number_in(row, "violation");
    a.evaluation_time = number_in(row, "evaluation_time_s", 0.0);
    a.verification_time = number_in(row, "verification_time_s", 0.0);
    if (const auto n = row.find("evaluations"); n != row.end()) {
      a.evaluations = evaluations_of(row);
      a.gradients = number_in(*n, "gradient", 0.0);
      a.jacobians = number_in(*n, "jacobian", 0.0);
      a.hessians = number_in(*n, "hessian", 0.0);
    }
  }

  struct Meeting {
    double time = infinite, evaluations = infinite;
  };

  /// The time when repeats came within `target` of the reference, as medians over them.
  /// @param to_the_end  whether a repeat that did not end with success counts as never reaching it
  static Meeting met(const std::vector<const batch::Row*>& repeats, const std::vector<Outcome>& outcomes,
                     double reference, double target, bool to_the_end) {
    const double goal = reference + target * std::max(1.0, std::abs(reference));
    std::vector<double> times, evaluations;
    for (std::size_t r = 0; r < repeats.size(); ++r) {
      const batch::Row& row = *repeats[r];
      const double wall = number_in(row, "wall_time_s");
      Meeting meeting;
      const auto history = row.find("history");
      for (const batch::Row& step : history != row.end() ? *history : batch::Row::array()) {
        if (!(step.at(2).get<double>() <= goal)) continue;
        meeting = {step.at(1), step.at(0)};
        break;
      }
      // The answer itself may be a point that was never evaluated as a whole.
      if (std::isinf(meeting.time) && outcomes[r].gap <= target && std::isfinite(wall))
        meeting = {wall, evaluations_of(row)};
      if (to_the_end && !(outcomes[r].success && std::isfinite(wall))) meeting = {};
      times.push_back(std::max(meeting.time, 1e-9));
      evaluations.push_back(std::max(meeting.evaluations, 1.0));
    }
    return {quartiles(times).median, quartiles(evaluations).median};
  }

  ComparisonData data_;
  std::vector<batch::Row> runs_;
  std::map<std::string, std::size_t> solver_index_;
};

}  // namespace

std::string_view to_string(Judgement judgement) {
  switch (judgement) {
    case Judgement::reached: return "reference reached";
    case Judgement::stationary: return "stationary, worse";
    case Judgement::feasible: return "feasible only";
    case Judgement::violates: return "breaks a limit";
    case Judgement::none: return "no point";
    case Judgement::impossible: return "problem infeasible";
  }
  return "?";
}

std::string difficulty_of(const ComparedCase& compared) {
  if (compared.proof != "proved" && !compared.infeasible) return "open";
  if (!compared.work) return "";
  const long n = *compared.work;
  return n <= 10 ? "easy" : n <= 100 ? "medium" : n <= 1000 ? "hard" : "very hard";
}

bool claims_solution(const Attempt& attempt) {
  return attempt.claim == "solved" || attempt.claim == "acceptable";
}

bool refuted_solution(const ComparedCase& compared, const Attempt& attempt) {
  return claims_solution(attempt) &&
         (attempt.judgement == Judgement::violates || attempt.judgement == Judgement::none || compared.infeasible);
}

bool denies_solution(const ComparedCase& compared, const Attempt& attempt) {
  return attempt.claim == "infeasible" && !compared.infeasible && std::isfinite(compared.reference);
}

bool wrong_claim(const ComparedCase& compared, const Attempt& attempt) {
  return refuted_solution(compared, attempt) || denies_solution(compared, attempt) || attempt.claim == "unbounded";
}

bool ComparisonData::worth_repeating(std::size_t c, int start, std::size_t solver) const {
  const Attempt& a = attempt(c, start, solver);
  if (a.claim == "refused" || a.claim == "crashed" || a.claim == "error" || a.claim == "missing") return false;
  return (a.claim != "killed" && a.claim != "time limit") || a.gap <= 10.0 * accuracy;
}

std::vector<std::size_t> ComparisonData::profiled(bool design) const {
  std::vector<std::size_t> indices;
  for (std::size_t c = 0; c < cases.size(); ++c) {
    if (!cases[c].infeasible && (cases[c].question == "design") == design) indices.push_back(c);
  }
  return indices;
}

std::vector<int> ComparisonData::variables(bool design) const {
  std::vector<int> n;
  for (const std::size_t c : profiled(design)) n.insert(n.end(), static_cast<std::size_t>(starts), cases[c].variables);
  return n;
}

bool ComparisonData::takes_part(bool design, std::size_t solver) const {
  for (const std::size_t c : profiled(design)) {
    for (int start = 0; start < starts; ++start) {
      if (attempt(c, start, solver).accepted) return true;
    }
  }
  return false;
}

ComparisonData read_comparison(const std::vector<std::string>& lines) {
  return Reader(lines).read();
}

}  // namespace accdec::comparison
