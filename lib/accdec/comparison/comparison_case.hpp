#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include <accdec/batch/row_numbers.hpp>
#include <accdec/certificate/instance_proof.hpp>
#include <accdec/design/formulation.hpp>
#include <accdec/result.hpp>
#include <accdec/task.hpp>

namespace accdec::comparison {

/// The question that solvers answer about a task at a given order.
enum class Question {
  margin,  ///< MarginProblem: least corner error at given delays; objective (error/tolerance)^2 of the worst corner
  delay,   ///< DelayProblem: least weighted delay, continuous; objective in samples
  design   ///< integer delays and taps by design_nlp around the solver; objective is the cycle time in samples
};
std::string_view to_string(Question question);
std::optional<Question> question_from_string(std::string_view name);

/// Whether a suite says that a problem has an answer.
enum class Expected { feasible, infeasible, unknown };
std::string_view to_string(Expected expected);
std::optional<Expected> expected_from_string(std::string_view name);

/// One problem of a comparison at one size.
struct CaseSpec {
  std::string name, family;
  Task task;
  Question question = Question::margin;
  int order = 0;            ///< N
  int size = 1;             ///< how many times finer than written the task is sampled (already applied: see `refined`)
  std::vector<int> delays;  ///< margin: d_j; delay: those at which limits on the blends are imposed; empty: 0, or as
                            ///< large as the start needs
  double time_limit = 0.0;  ///< s, instead of the comparison's; 0: that
  Expected expected = Expected::feasible;  ///< whether some filter holds all limits
  std::string identity;  ///< distinguishes it from every other problem, whatever its name; empty: no earlier result is
                         ///< used
};

/// The same motion sampled `factor` times as often: period over factor, order such that the filter lasts as long,
/// delays times factor.
CaseSpec refined(CaseSpec spec, int factor);

/// A problem as solvers see it. Solvers that take no equality rows get the reduced form, in which positions are
/// substituted into their bounds. Every answer is judged by the rows and the objective of this form.
class ComparisonCase {
 public:
  explicit ComparisonCase(CaseSpec spec);

  const CaseSpec& spec() const { return spec_; }
  /// One of the two forms; null for Question::design.
  const nlp::Problem* problem(bool reduced) const { return reduced ? reduced_.get() : sparse_.get(); }
  /// Start `index` of a seed, the same for every solver. Start 0 is a trapezoid with a third of it as ramps, and the
  /// delays it needs. The other starts have every tap multiplied by exp(u), u uniform in -1 .. 1, and every free delay
  /// by a factor in 0.5 .. 1.5.
  std::vector<double> start(bool reduced, int index, std::uint64_t seed) const;
  /// The filter of a start; a whole design starts only from it.
  Filter start_filter(int index, std::uint64_t seed) const;
  /// A point of either form in the variables of the reduced one.
  std::vector<double> to_reduced(bool reduced, const std::vector<double>& x) const;
  int variables() const;  ///< of the reduced form; order + corners for Question::design
  int rows() const;
  /// The question in words: the variables and the given values.
  std::string asks() const;
  /// Why an answer to the question is none to the task; empty if it is. Then nobody is asked and nothing is proved. The
  /// task may narrow its taps or delays (a filter, a family, whole coefficients, kinds of delays). Or rows of
  /// `margin` and `delay` are not its limits: they count dry friction both ways, and none states an exact stop.
  const std::string& objection() const { return objection_; }
  const std::vector<int>& samples() const {
    return samples_;
  }                                                                       ///< margin: k_j, the samples of the start's
                                                                          ///< errors
  const std::vector<int>& blend_delays() const { return blend_delays_; }  ///< at which limits on the blends are imposed

 private:
  std::mt19937_64 generator(int index, std::uint64_t seed) const;
  Filter start_filter(int index, std::mt19937_64& rng) const;  ///< draws from the generator

  /// Why the rows of corner errors are not those of the task. @param longest  order of the motion behind the machine's
  /// response
  std::string unstated_error(int longest) const;

  CaseSpec spec_;
  std::string objection_;
  std::vector<int> samples_, blend_delays_;
  bool delays_given_ = false;
  std::unique_ptr<nlp::Problem> sparse_, reduced_;
  std::vector<std::size_t> common_;  ///< sparse variable of each reduced one
};

/// Adds what a case is to a record of it: problem, family, question, size, order.
/// @param question  the key of the question
void describe(batch::Row& row, const char* question, const ComparisonCase& subject);

/// Knowledge of a case's optimum from none of the compared solvers.
struct Reference {
  enum class Proof {
    optimal,     ///< a known point has `upper`, and nothing is below `lower`
    infeasible,  ///< no point holds all rows
    bound        ///< nothing is below `lower`; that is all that is known
  };
  Proof proof = Proof::bound;
  double lower = 0.0, upper = 0.0;  ///< of the objective; upper infinite unless proof is optimal
  std::string method;               ///< the method in words
  long work = 0;                    ///< linear programs solved
  std::shared_ptr<const InstanceProof>
      refutation{};  ///< of `margin` and `delay`: why nothing is below; null: not known
};
std::string_view to_string(Reference::Proof proof);

/// Computed by the exact method: linear programs with tangent cuts and checked dual multipliers. If power, regeneration
/// or a smallest speed is limited, it also branches and bounds on responses. Known points hold all rows to 1e-7.
///
/// For `margin` it brackets the tolerance between a refuted value and one that holds, to 5e-5 of the objective, or to
/// 1e-6 if this is quick.
///
/// For `delay` it refutes delays 5e-5 below a known one, one interval of instants after another (DelaySearch). With
/// several corners, the bound is the sum of what each corner needs alone; a filter that is best for all corners reaches
/// it.
///
/// For `design` it is `design_exact` at this order, if that knows all limits. For the others there is none behind a
/// machine's response, nor with limits of contours, the supply and modes of axes. Without one, the bound is 0. In
/// comparison_reference.cpp.
/// @param time_limit  s
Reference reference_of(const ComparisonCase& subject, double time_limit);

/// The exact method on the task of a `design` case, at its order. @param time_limit  s
DesignResult exact_at_order(const CaseSpec& spec, double time_limit, bool certificate);
/// The reference that its result is.
Reference reference_of(const DesignResult& result);

}  // namespace accdec::comparison
