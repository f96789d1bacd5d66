#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/comparison/comparison_answer.hpp>

namespace accdec {
namespace {

using comparison::Attempt;
using comparison::ComparisonData;

struct Score {
  std::string solver;
  std::size_t reached = 0, problems = 0;  ///< problems: feasible ones, from every start
  double ratio = NAN;                     ///< median of time to accuracy over the least one, where it was reached
  std::size_t claims = 0, wrong = 0;      ///< of a solution, or that there is none
  double share() const { return problems > 0 ? static_cast<double>(reached) / static_cast<double>(problems) : 0.0; }
};

void count_claims(const ComparisonData& data, std::size_t s, Score& score) {
  for (std::size_t c = 0; c < data.cases.size(); ++c) {
    for (int start = 0; start < data.starts; ++start) {
      const Attempt& a = data.attempt(c, start, s);
      if (comparison::claims_solution(a) || a.claim == "infeasible" || a.claim == "unbounded") ++score.claims;
      if (comparison::wrong_claim(data.cases[c], a)) ++score.wrong;
    }
  }
}

/// The most reliable first; among equals, the fastest first.
std::vector<Score> scores_of(const ComparisonData& data) {
  std::vector<Score> scores(data.solvers.size());
  std::vector<std::vector<double>> ratios(data.solvers.size());
  for (const bool design : {false, true}) {
    if (data.profiled(design).empty()) continue;
    const auto costs = data.costs(design, [](const Attempt& a) { return a.accuracy_cost; });
    const auto over_least = comparison::performance_ratios(costs, data.plain);
    for (std::size_t s = 0; s < scores.size(); ++s) {
      scores[s].problems += costs[s].size();
      for (std::size_t p = 0; p < costs[s].size(); ++p) {
        if (!std::isfinite(costs[s][p])) continue;
        ++scores[s].reached;
        ratios[s].push_back(over_least[s][p]);
      }
    }
  }
  for (std::size_t s = 0; s < scores.size(); ++s) {
    scores[s].solver = data.solvers[s];
    if (!ratios[s].empty()) scores[s].ratio = comparison::quartiles(ratios[s]).median;
    count_claims(data, s, scores[s]);
  }
  std::stable_sort(scores.begin(), scores.end(), [](const Score& a, const Score& b) {
    if (a.reached != b.reached) return a.reached > b.reached;
    return a.ratio < b.ratio || (std::isnan(b.ratio) && !std::isnan(a.ratio));
  });
  return scores;
}

std::string names_of(const std::vector<std::string>& names) {
  if (names.size() == 1) return names.front();
  return fmt::format("{} and {}", fmt::join(names.begin(), names.end() - 1, ", "), names.back());
}

std::string most_reliable(const std::vector<Score>& scores) {
  const Score& best = scores.front();
  if (best.problems == 0) return "No problem of this suite is feasible, so there is no reference to reach.";
  if (best.reached == 0) return "No solver reached the reference of any problem.";
  std::vector<std::string> first;
  for (const Score& s : scores) {
    if (s.reached == best.reached) first.push_back(s.solver);
  }
  std::string text = fmt::format("{} reached the reference most often: {} of {} times ({:.3g} %)", names_of(first),
                                 best.reached, best.problems, 100.0 * best.share());
  if (first.size() < scores.size()) {
    const Score& next = scores[first.size()];
    text += fmt::format("; next is {} with {:.3g} %", next.solver, 100.0 * next.share());
  }
  return text + ".";
}

/// A solver that is fast on only a few problems does not count: only solvers with half the best share do.
std::string fastest(const std::vector<Score>& scores) {
  const Score* fastest = nullptr;
  for (const Score& s : scores) {
    if (s.reached == 0 || 2 * s.reached < scores.front().reached) continue;
    if (!fastest || s.ratio < fastest->ratio) fastest = &s;
  }
  if (!fastest) return "";
  std::string text = fmt::format(
      "Of those that reached it at least half as often as the best, {} was the fastest: its median time is "
      "{:.3g} times the least of the plain solvers",
      fastest->solver, fastest->ratio);
  if (fastest != &scores.front())
    text += fmt::format(", that of {} {:.3g} times", scores.front().solver, scores.front().ratio);
  return text + ".";
}

std::string wrong_claims(const std::vector<Score>& scores) {
  std::size_t claims = 0, wrong = 0;
  const Score* most = nullptr;
  for (const Score& s : scores) {
    claims += s.claims;
    wrong += s.wrong;
    if (s.wrong > 0 && (!most || s.wrong > most->wrong)) most = &s;
  }
  if (!most) return fmt::format("None of the {} claims was wrong.", claims);
  return fmt::format("{} of {} claims were wrong by recomputation, most of them by {} ({} of {}).", wrong, claims,
                     most->solver, most->wrong, most->claims);
}

}  // namespace

ComparisonTable answer_table(const ComparisonData& data) {
  ComparisonTable table{"answer",
                        {"solver", "reached the reference / %", "of runs", "median time / fastest, where reached",
                         "wrong claims", "claims"},
                        {}};
  for (const Score& s : scores_of(data)) {
    table.rows.push_back({s.solver, fmt::format("{:.1f}", 100.0 * s.share()), fmt::format("{}", s.problems),
                          std::isnan(s.ratio) ? "" : fmt::format("{:.3g}", s.ratio), fmt::format("{}", s.wrong),
                          fmt::format("{}", s.claims)});
  }
  return table;
}

std::string answer_text(const ComparisonData& data) {
  const std::vector<Score> scores = scores_of(data);
  std::string text = most_reliable(scores);
  for (const std::string& sentence : {fastest(scores), wrong_claims(scores)}) {
    if (!sentence.empty()) text += " " + sentence;
  }
  return text;
}

}  // namespace accdec
