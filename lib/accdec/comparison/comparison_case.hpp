#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include <accdec/design/formulation.hpp>
#include <accdec/task/task.hpp>

namespace accdec::comparison {

/// What solvers are asked of a task at a given order.
enum class Question {
  margin,  ///< MarginProblem: least corner error at given delays; objective (error/tolerance)^2 of the worst corner
  delay,   ///< DelayProblem: least weighted delay, continuous; objective in samples
  design   ///< integer delays and taps by design_nlp around the solver; objective is the cycle time in samples
};
std::string_view to_string(Question question);
std::optional<Question> question_from_string(std::string_view name);

/// One problem of a comparison at one size.
struct CaseSpec {
  std::string name, family;
  Task task;
  Question question = Question::margin;
  int order = 0;  ///< N
  int size = 1;   ///< how many times finer than written the task is sampled (already done: see `refined`)
  std::vector<int>
      delays;  ///< margin: d_j; delay: at which limits on the blends are imposed; empty: 0, and what the start needs
  double time_limit = 0.0;  ///< s, instead of the comparison's; 0: that
  bool infeasible = false;  ///< the suite says that nothing holds all limits
  std::string identity;  ///< tells it from every other problem, whatever its name; empty: nothing found is used again
};

/// The same motion sampled `factor` times as often: period over factor, order such that the filter lasts as long,
/// delays times factor.
CaseSpec refined(CaseSpec spec, int factor);

/// A problem as solvers see it. Solvers that take no equality rows get the reduced form, in which positions are
/// substituted into their bounds; its rows and its objective are what every answer is judged by.
class ComparisonCase {
 public:
  explicit ComparisonCase(CaseSpec spec);

  const CaseSpec& spec() const { return spec_; }
  /// Of the reduced form; null for Question::design.
  const nlp::Problem* problem(bool reduced) const { return reduced ? reduced_.get() : sparse_.get(); }
  /// Start `index` of a seed, the same for every solver: 0 is a trapezoid a third of which is ramp, with the delays it
  /// needs; the others have every tap multiplied by exp(u), u uniform in -1 .. 1, and every free delay by a factor in
  /// 0.5 .. 1.5.
  std::vector<double> start(bool reduced, int index, std::uint64_t seed) const;
  /// Its filter, all that a whole design starts from.
  Filter start_filter(int index, std::uint64_t seed) const;
  /// A point of either form in the variables of the reduced one.
  std::vector<double> to_reduced(bool reduced, const std::vector<double>& x) const;
  int variables() const;  ///< of the reduced form; order + corners for Question::design
  int rows() const;
  /// What is asked, in words: what varies and what is given.
  std::string asks() const;
  const std::vector<int>& samples() const { return samples_; }            ///< margin: k_j, where the start's errors are
  const std::vector<int>& blend_delays() const { return blend_delays_; }  ///< at which limits on the blends are imposed

 private:
  std::mt19937_64 generator(int index, std::uint64_t seed) const;
  Filter start_filter(int index, std::mt19937_64& rng) const;  ///< takes from the generator what it needs

  CaseSpec spec_;
  std::vector<int> samples_, blend_delays_;
  bool delays_given_ = false;
  std::unique_ptr<nlp::Problem> sparse_, reduced_;
  std::vector<std::size_t> common_;  ///< sparse variable of each reduced one
};

/// What is known of a case's optimum without any of the compared solvers.
struct Reference {
  enum class Proof {
    optimal,     ///< `upper` is reached by a known point and nothing is below `lower`
    infeasible,  ///< no point holds all rows
    bound        ///< nothing is below `lower`; no more is known
  };
  Proof proof = Proof::bound;
  double lower = 0.0, upper = 0.0;  ///< of the objective; upper infinite unless proof is optimal
  std::string method;               ///< how, in words
};
std::string_view to_string(Reference::Proof proof);

/// By the exact method: linear programs with tangent cuts and checked dual multipliers, and branch and bound on
/// responses where power, regeneration or a smallest speed is limited. Known points hold all rows to 1e-7.
///   margin  brackets the tolerance between a refuted and a held one, to 5e-5 of the objective, where that is soon done
///   to 1e-6 delay   refutes, interval of instants by interval, delays 5e-5 below a known one (DelaySearch); with
///   several corners the bound is
///           the sum of what each needs on its own, which a filter that is best for all of them reaches
///   design  design_exact at this order
/// @param time_limit  s
Reference reference_of(const ComparisonCase& subject, double time_limit);

}  // namespace accdec::comparison
