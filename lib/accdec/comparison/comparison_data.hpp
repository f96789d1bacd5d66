#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <accdec/batch/row_numbers.hpp>
#include <accdec/comparison/performance_profile.hpp>

namespace accdec::comparison {

/// The claim in the row of a run whose process was killed by the timer, or died.
inline constexpr std::string_view claim_killed = "killed", claim_crashed = "crashed";
/// Whether a run gave no answer because its process ended first.
inline bool lost(std::string_view claim) {
  return claim == claim_killed || claim == claim_crashed;
}

/// A problem at one size with the reference its runs are judged by.
struct ComparedCase {
  std::string problem, family, question, method;
  std::string asks;  ///< the question in words; empty in older raw data
  int size = 1, order = 0, variables = 0, rows = 0;
  double time_limit = 0.0;   ///< s; 0: the header's
  std::string expected;      ///< "feasible", "infeasible", "unknown"
  std::optional<long> work;  ///< linear programs of the exact method; none in older raw data
  bool infeasible = false;   ///< proved
  double lower = 0.0;        ///< proved; NaN if infeasible
  double reference = 0.0;    ///< NaN if infeasible, or if no solver found a feasible point and nothing is proved
  std::string proof;         ///< "proved", "best known", "infeasible proved", "unknown"
};

/// The work of the exact method for the proof of a problem: "easy" to 10 linear programs, "medium" to 100, "hard" to
/// 1000, "very hard" above. It is "open" without a proof, and empty in older raw data, which do not say.
std::string difficulty_of(const ComparedCase& compared);
inline constexpr const char* difficulties[] = {"easy", "medium", "hard", "very hard", "open"};

/// The outcome of a run, by recomputation.
enum class Judgement {
  reached,     ///< feasible, and as good as the reference within the accuracy
  stationary,  ///< feasible and first-order optimal, but worse than the reference
  feasible,    ///< feasible only
  violates,    ///< breaks a row or bound
  none,        ///< no point to judge
  impossible   ///< there is no solution: the problem is proved infeasible
};
inline constexpr Judgement judgements[] = {Judgement::reached,  Judgement::stationary, Judgement::feasible,
                                           Judgement::violates, Judgement::none,       Judgement::impossible};
std::string_view to_string(Judgement judgement);

inline constexpr double infinite = std::numeric_limits<double>::infinity();

/// A solver on a case from a start, all repeats together. The outcome is that of most repeats; single values are from
/// the first of these.
struct Attempt {
  /// An answer of a program after the time limit claims "time limit". If its own claim is wrong, it stands.
  std::string claim = "missing", message;
  Judgement judgement = Judgement::none;
  bool success = false;  ///< reached; on an infeasible case: claimed "infeasible", not only that no design was found
  bool accepted = true;  ///< false: refused
  bool lost = false;     ///< its process, or the program that it started, was killed or crashed
  double objective = 0.0, gap = 0.0, violation = 0.0;  ///< gap relative to max(1, reference); NaN where there is none
  std::vector<double> times;                           ///< s, one per repeat
  std::size_t successes = 0;                           ///< repeats
  Quartiles time;
  double evaluations = 0.0, gradients = 0.0, jacobians = 0.0, hessians = 0.0;
  double evaluation_time = 0.0, verification_time = 0.0;  ///< s
  std::vector<double> target_time,
      target_evaluations;  ///< until within each target, medians over repeats, infinite if never
  /// Costs of the performance profiles, s: medians over repeats, infinite for repeats without success. So both costs
  /// are finite for the same problems.
  double end_cost = infinite;  ///< until the solver ended
  /// Until the first feasible point within the accuracy of the reference. A repeat that met such a point but returned
  /// another one counts as infinite too, because a user who does not know the reference has only the answer. (Targets
  /// count even if the final answer is another.)
  double accuracy_cost = infinite;
};

/// Whether a run claims a solution, and whether recomputation refutes that: it breaks a limit, has no point, or there
/// is no solution.
bool claims_solution(const Attempt& attempt);
bool refuted_solution(const ComparedCase& compared, const Attempt& attempt);
/// Whether a run claims that there is no solution, though one is known.
bool denies_solution(const ComparedCase& compared, const Attempt& attempt);
/// Any of the two, or "unbounded": no cost of these problems is below zero.
bool wrong_claim(const ComparedCase& compared, const Attempt& attempt);

/// The raw data as read: everything that tables and figures are made from.
struct ComparisonData {
  batch::Row header;
  std::vector<std::string> solvers;
  std::vector<std::string> algorithms;  ///< registry name of each of them
  std::vector<std::size_t>
      plain;  ///< those that are not variants: under the algorithm's own name, or in one of its forms
  std::vector<double> targets;
  int starts = 1, repeats = 1;
  double accuracy = 1e-4;
  std::vector<ComparedCase> cases;
  std::vector<Attempt> attempts;  ///< (case * starts + start) * solvers + solver
  std::vector<std::string>
      contradictions;  ///< impossible findings: a proof beaten, a feasible point of an infeasible problem, ...
  batch::Row session;  ///< the record of how time was spent; null without one

  /// Whether a run is worth timing again, judged by its first repeat. It is not if it was refused or failed. It is also
  /// not if it used up its time and ended ten times farther from the reference than the accuracy, because clock noise
  /// does not explain that.
  bool worth_repeating(std::size_t c, int start, std::size_t solver) const;

  const Attempt& attempt(std::size_t c, int start, std::size_t solver) const {
    return attempts[(c * static_cast<std::size_t>(starts) + static_cast<std::size_t>(start)) * solvers.size() + solver];
  }
  /// Cases for the profiles: those of the integer design or of the nonlinear problems, if not proved infeasible.
  std::vector<std::size_t> profiled(bool design) const;
  /// [solver][case x start] over `profiled`; what(attempt) is the cost.
  template <class What>
  std::vector<std::vector<double>> costs(bool design, What what) const {
    std::vector<std::vector<double>> table(solvers.size());
    for (const std::size_t c : profiled(design)) {
      for (int start = 0; start < starts; ++start) {
        for (std::size_t s = 0; s < solvers.size(); ++s) table[s].push_back(what(attempt(c, start, s)));
      }
    }
    return table;
  }
  /// Variables of each entry of `costs`.
  std::vector<int> variables(bool design) const;
  /// Whether the solver accepted any of the problems in `costs`.
  bool takes_part(bool design, std::size_t solver) const;
};

/// @param lines  of raw.jsonl, in any order after the header
/// @throws std::invalid_argument naming the line that is not a record of a comparison, or what is missing.
ComparisonData read_comparison(const std::vector<std::string>& lines);

}  // namespace accdec::comparison
