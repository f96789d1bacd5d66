#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include <accdec/comparison/comparison_report.hpp>

namespace accdec {
namespace {

using comparison::Attempt;
using comparison::ComparedCase;
using comparison::ComparisonData;
using comparison::Judgement;

std::string shown(double x, int digits = 4) {
  return std::isfinite(x) ? fmt::format("{:.{}g}", x, digits) : "";
}

constexpr std::size_t judgement_count = std::size(comparison::judgements);
std::size_t position(Judgement j) {
  return static_cast<std::size_t>(j);
}

/// Every attempt of one solver.
template <class Visit>
void each_attempt(const ComparisonData& data, std::size_t solver, Visit visit) {
  for (std::size_t c = 0; c < data.cases.size(); ++c) {
    for (int start = 0; start < data.starts; ++start) visit(data.cases[c], start, data.attempt(c, start, solver));
  }
}

std::string text(const batch::Row& row, const char* key) {
  return row.value(key, std::string());
}

}  // namespace

ComparisonTable problems_table(const ComparisonData& data) {
  ComparisonTable t{"problems",
                    {"problem", "family", "formulation", "size", "order", "variables", "rows", "reference", "proof",
                     "proved bound", "how", "asks"},
                    {}};
  for (const ComparedCase& c : data.cases) {
    t.rows.push_back({c.problem, c.family, c.question, fmt::format("{}", c.size), fmt::format("{}", c.order),
                      fmt::format("{}", c.variables), fmt::format("{}", c.rows), shown(c.reference, 8), c.proof,
                      shown(c.lower, 8), c.method, c.asks});
  }
  return t;
}

namespace {

/// Totals of all attempts of one solver.
struct Tally {
  std::string solver;
  const batch::Row* about = nullptr;  ///< of the raw data's header
  std::array<std::size_t, judgement_count> judged{};
  std::size_t runs = 0, refused = 0, lost = 0, recognised = 0, none_found = 0, refuted = 0, wrong = 0;
  std::vector<double> times, accuracy_times, polishing, evaluations;
  double inside = 0.0, wall = 0.0;  ///< s, in the evaluator and in total

  void add(const ComparedCase& c, const Attempt& a) {
    ++runs;
    if (!a.accepted) {
      ++refused;
      if (c.infeasible) ++judged[position(Judgement::impossible)];
      return;
    }
    if (a.lost) ++lost;
    ++judged[position(a.judgement)];
    if (c.infeasible && a.success) ++recognised;
    if (c.infeasible && a.claim == "no design") ++none_found;
    if (comparison::refuted_solution(c, a)) ++refuted;
    if (comparison::wrong_claim(c, a)) ++wrong;
    if (a.success && !c.infeasible) {
      times.push_back(a.time.median);
      accuracy_times.push_back(a.accuracy_cost);
      polishing.push_back(a.end_cost / a.accuracy_cost);
      evaluations.push_back(a.evaluations);
    }
    if (!a.times.empty()) {
      inside += a.evaluation_time;
      wall += a.times.front();
    }
  }
};

/// A column of the summary: its heading and its cells.
struct SummaryColumn {
  const char* heading;
  std::string (*cell)(const Tally&);
};

std::string whole(std::size_t n) {
  return fmt::format("{}", n);
}
template <Judgement J>
std::string judged(const Tally& t) {
  return whole(t.judged[position(J)]);
}
std::string lower(const std::vector<double>& values) {
  return shown(comparison::quartiles(values).lower);
}
std::string median(const std::vector<double>& values) {
  return shown(comparison::quartiles(values).median);
}
std::string upper(const std::vector<double>& values) {
  return shown(comparison::quartiles(values).upper);
}

const SummaryColumn summary_columns[] = {
    {"solver", [](const Tally& t) { return t.solver; }},
    {"library", [](const Tally& t) { return text(*t.about, "library"); }},
    {"search", [](const Tally& t) { return text(*t.about, "search"); }},
    {"uses", [](const Tally& t) { return text(*t.about, "uses"); }},
    {"form", [](const Tally& t) { return text(*t.about, "form"); }},
    {"runs", [](const Tally& t) { return whole(t.runs); }},
    {"refused", [](const Tally& t) { return whole(t.refused); }},
    {"killed or crashed", [](const Tally& t) { return whole(t.lost); }},
    {"reference reached", judged<Judgement::reached>},
    {"stationary, worse", judged<Judgement::stationary>},
    {"feasible only", judged<Judgement::feasible>},
    {"breaks a limit", judged<Judgement::violates>},
    {"no point", judged<Judgement::none>},
    {"infeasible recognised", [](const Tally& t) { return whole(t.recognised); }},
    {"infeasible: no design found", [](const Tally& t) { return whole(t.none_found); }},
    {"infeasible in all", judged<Judgement::impossible>},
    {"claimed solved, refuted", [](const Tally& t) { return whole(t.refuted); }},
    {"wrong claims", [](const Tally& t) { return whole(t.wrong); }},
    {"time to end lower quartile / s", [](const Tally& t) { return lower(t.times); }},
    {"time to end median / s", [](const Tally& t) { return median(t.times); }},
    {"time to end upper quartile / s", [](const Tally& t) { return upper(t.times); }},
    {"time to accuracy lower quartile / s", [](const Tally& t) { return lower(t.accuracy_times); }},
    {"time to accuracy median / s", [](const Tally& t) { return median(t.accuracy_times); }},
    {"time to accuracy upper quartile / s", [](const Tally& t) { return upper(t.accuracy_times); }},
    {"median of time to end / time to accuracy",
     [](const Tally& t) { return shown(comparison::quartiles(t.polishing).median, 3); }},
    {"evaluations lower quartile", [](const Tally& t) { return lower(t.evaluations); }},
    {"evaluations median", [](const Tally& t) { return median(t.evaluations); }},
    {"evaluations upper quartile", [](const Tally& t) { return upper(t.evaluations); }},
    {"share of time in the evaluator", [](const Tally& t) { return t.wall > 0.0 ? shown(t.inside / t.wall, 3) : ""; }},
};

}  // namespace

ComparisonTable summary_table(const ComparisonData& data) {
  ComparisonTable t{"summary", {}, {}};
  for (const SummaryColumn& column : summary_columns) t.head.emplace_back(column.heading);
  for (std::size_t s = 0; s < data.solvers.size(); ++s) {
    Tally tally;
    tally.solver = data.solvers[s];
    tally.about = &data.header.at("solvers").at(s);
    each_attempt(data, s, [&](const ComparedCase& c, int, const Attempt& a) { tally.add(c, a); });
    std::vector<std::string>& row = t.rows.emplace_back();
    for (const SummaryColumn& column : summary_columns) row.push_back(column.cell(tally));
  }
  return t;
}

ComparisonTable confusion_table(const ComparisonData& data) {
  ComparisonTable t{"confusion", {"solver", "claimed"}, {}};
  for (const Judgement j : comparison::judgements) t.head.emplace_back(to_string(j));
  using Counts = std::map<std::string, std::array<std::size_t, judgement_count>>;
  const auto add = [&](const std::string& solver, const Counts& counts) {
    for (const auto& [claim, row] : counts) {
      t.rows.push_back({solver, claim});
      for (const std::size_t n : row) t.rows.back().push_back(fmt::format("{}", n));
    }
  };
  Counts all;
  std::vector<Counts> single(data.solvers.size());
  for (std::size_t s = 0; s < data.solvers.size(); ++s) {
    each_attempt(data, s, [&](const ComparedCase&, int, const Attempt& a) {
      ++single[s][a.claim][position(a.judgement)];
      ++all[a.claim][position(a.judgement)];
    });
  }
  add("all", all);
  for (std::size_t s = 0; s < data.solvers.size(); ++s) add(data.solvers[s], single[s]);
  return t;
}

ComparisonTable runs_table(const ComparisonData& data) {
  ComparisonTable t{"runs",
                    {"problem",
                     "formulation",
                     "size",
                     "start",
                     "solver",
                     "claimed",
                     "verified",
                     "success",
                     "objective",
                     "gap",
                     "violation",
                     "repeats",
                     "of these successes",
                     "time to end lower quartile / s",
                     "time to end median / s",
                     "time to end upper quartile / s",
                     "time to accuracy median / s",
                     "evaluations",
                     "gradients",
                     "jacobians",
                     "hessians",
                     "evaluator time / s",
                     "message"},
                    {}};
  for (std::size_t c = 0; c < data.cases.size(); ++c) {
    const ComparedCase& problem = data.cases[c];
    for (int start = 0; start < data.starts; ++start) {
      for (std::size_t s = 0; s < data.solvers.size(); ++s) {
        const Attempt& a = data.attempt(c, start, s);
        t.rows.push_back({problem.problem,
                          problem.question,
                          fmt::format("{}", problem.size),
                          fmt::format("{}", start),
                          data.solvers[s],
                          a.claim,
                          std::string(to_string(a.judgement)),
                          a.success ? "yes" : "no",
                          shown(a.objective, 9),
                          shown(a.gap, 3),
                          shown(a.violation, 3),
                          fmt::format("{}", a.times.size()),
                          fmt::format("{}", a.successes),
                          shown(a.time.lower),
                          shown(a.time.median),
                          shown(a.time.upper),
                          shown(a.accuracy_cost),
                          shown(a.evaluations, 12),
                          shown(a.gradients, 12),
                          shown(a.jacobians, 12),
                          shown(a.hessians, 12),
                          shown(a.evaluation_time),
                          a.message});
      }
    }
  }
  return t;
}

ComparisonTable pairs_table(const ComparisonData& data) {
  ComparisonTable t{"pairs",
                    {"level", "solver", "against", "solved by it", "least time to accuracy or equal (ratio 1)",
                     "within ratio 2", "within ratio 10"},
                    {}};
  for (const bool design : {false, true}) {
    const auto costs = data.costs(design, [](const Attempt& a) { return a.accuracy_cost; });
    if (costs.empty() || costs.front().empty()) continue;
    for (std::size_t a = 0; a < data.solvers.size(); ++a) {
      for (std::size_t b = 0; b < data.solvers.size(); ++b) {
        if (a == b || !data.takes_part(design, a) || !data.takes_part(design, b)) continue;
        const auto d = comparison::distribution(comparison::performance_ratios({costs[a], costs[b]}).front());
        t.rows.push_back({design ? "design" : "nonlinear problem", data.solvers[a], data.solvers[b],
                          shown(d.y.empty() ? 0.0 : d.y.back(), 3), shown(comparison::at(d, 1.0), 3),
                          shown(comparison::at(d, 2.0), 3), shown(comparison::at(d, 10.0), 3)});
      }
    }
  }
  return t;
}

}  // namespace accdec
