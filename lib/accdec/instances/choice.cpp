#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include <accdec/exact/rows.hpp>
#include <accdec/instances/instance.hpp>
#include <accdec/machine/response.hpp>

namespace accdec::instances {
namespace {

/// Builds `choice_of`.
class ChoiceBuilder {
 public:
  ChoiceBuilder(const Task& task, int order)
      : task_(task),
        problem_(choice_.problem),
        b_(add_cumulative_variables(problem_, order)),
        tap_max_(exact::ConvexRows(task).tap_max()) {
    options_.order = order;
    options_.margin = 0.0;
    options_.mode_frequencies = initial_frequencies(task, order);
    options_.blend_delays.assign(task.corners.size(), 0);
  }

  Choice build() {
    add_common_rows(problem_, b_, task_, options_);
    for (std::size_t j = 0; j < task_.corners.size(); ++j) corner(j);
    const bool each = task_.design.objective == Objective::corner;
    objective_.constant += each ? 0.0 : task_.design.runs * (order() + 1);
    for (const TaskCorner& c : task_.corners) objective_.constant += each ? c.weight * (order() + 1) : 0.0;
    problem_.set_objective(objective_);
    problem_.set_name("whole choice of taps and delays");
    problem_.finish();
    choice_.start.assign(count(problem_.num_variables()), 0.0);
    for (int k = 1; k <= order(); ++k) choice_.start[count(k - 1)] = k / (order() + 1.0);
    return std::move(choice_);
  }

 private:
  static std::size_t count(int i) { return static_cast<std::size_t>(i); }
  int order() const { return options_.order; }

  int binary(std::string name) {
    const int variable = problem_.add_variable(std::move(name), {0.0, 1.0});
    problem_.set_integer(variable);
    return variable;
  }

  /// Binary variables of sum 1, one for each value low .. high, and the value as their sum.
  std::vector<int> choice(const std::string& name, int low, int high, Affine& value) {
    std::vector<int> variables;
    const int row = problem_.add_row("one " + name, {1.0, 1.0});
    for (int v = low; v <= high; ++v) {
      variables.push_back(binary(fmt::format("{} = {}", name, v)));
      problem_.add_to_row(row, {0.0, {{variables.back(), 1.0}}});
      if (v != 0) value.add(variables.back(), v);
    }
    return variables;
  }

  void corner(std::size_t j) {
    const TaskCorner& corner = task_.corners[j];
    // Two samples after the first leg has come to rest, no difference of the commands spans both legs.
    const int low = corner.delay.value_or(0), high = corner.delay.value_or(order() + 2);
    Affine delay;
    const std::vector<int> chosen = choice("delay, corner " + corner.name, low, high, delay);
    objective_ += corner.weight * delay;
    choice_.delays.push_back(delay);
    for (int d = low; d <= high; ++d) blend(j, d, chosen[count(d - low)]);
    if (corner.error_max) error(corner, delay, high);
  }

  /// Rows of the blend at one delay, which hold where `chosen` is 1.
  void blend(std::size_t j, int delay, int chosen) {
    QuadraticProblem rows;
    const CumulativeVariables b = add_cumulative_variables(rows, order());
    options_.blend_delays[j] = delay;
    add_blend_rows(rows, b, task_, options_, j);
    rows.finish();
    for (int r = 0; r < rows.num_rows(); ++r) {
      const Polynomial body = rows.polynomial(r);
      const nlp::Bound bound = rows.row_bound(r);
      const std::string name = fmt::format("{}, delay {}", rows.row_name(r), delay);
      if (std::isfinite(bound.upper)) switched(name + ", from above", body, 1.0, bound.upper, chosen);
      if (std::isfinite(bound.lower)) switched(name + ", from below", body, -1.0, -bound.lower, chosen);
    }
  }

  /// sign * body <= bound + M (1 - chosen); no row if it holds anyway.
  void switched(const std::string& name, const Polynomial& body, double sign, double bound, int chosen) {
    const double m = largest(body, sign) - bound;
    if (m <= 0.0) return;
    const int row = problem_.add_row(name, {-nlp::infinity, bound + m});
    problem_.add_to_row(row, sign * body.affine + Affine{0.0, {{chosen, m}}});
    for (const auto& p : body.products)
      problem_.add_product(row, sign * p.coefficient, {0.0, {{p.first, 1.0}}}, {0.0, {{p.second, 1.0}}});
  }

  /// Bound of sign * body over 0 <= B <= 1, and of its affine part over 0 <= taps <= tap_max with sum 1 as well.
  double largest(const Polynomial& body, double sign) const {
    double in_sums = 0.0, products = 0.0;
    for (const auto& term : body.affine.terms) in_sums += std::max(0.0, sign * term.second);
    for (const auto& p : body.products) products += std::max(0.0, sign * p.coefficient);
    const double constant = sign * body.affine.constant;
    const double in_taps = largest_over_taps(sign * body.affine, order(), tap_max_) - constant;
    // Rounding of the sums must not cut anything off.
    return constant + products + std::min(in_sums, in_taps) * (1.0 + 1e-12) + 1e-12;
  }

  /// |S[k]|^2 <= 1 in units of the tolerance, with P = p(k) and Q = Q(m) at the chosen k and m = k - delay. Both are 0
  /// where the tolerance is, if the corner turns. @param longest  the largest delay
  void error(const TaskCorner& corner, const Affine& delay, int longest) {
    const bool exact = *corner.error_max == 0.0, straight = corner.geometry().cos_interior() < -1.0 + 1e-12;
    const double unit = exact ? corner.geometry().feed_in * task_.sample_period : *corner.error_max;
    const double in = corner.geometry().feed_in * task_.sample_period / unit;
    const double out = corner.geometry().feed_out * task_.sample_period / unit;
    const double cosine = corner.geometry().cos_interior();
    // |S| <= 1 bounds both distances: |S|^2 >= (1 - c^2) P^2.
    const double most = exact && straight ? std::max(in, out) * order()
                        : exact           ? 0.0
                                : (1.0 + 1e-9) / std::sqrt(std::max(1e-12, cosine < 0.0 ? 1.0 - cosine * cosine : 1.0));
    Affine k, m;
    // A delay may be longer than the filter: then the legs do not overlap.
    const int last = std::max(order(), longest);
    const std::vector<int> samples = choice("sample, corner " + corner.name, 0, last, k);
    const std::vector<int> since = choice("sample after the delay, corner " + corner.name, 0, order(), m);
    problem_.add_to_row(problem_.add_row("delay of corner " + corner.name, {0.0, 0.0}), delay + -1.0 * k + m);
    const int p = tied(
        "P " + corner.name, std::min(most, in * order()), [&](int i) { return in * b_.remaining_moment(i); },
        [&](int i) { return in * std::max(0, order() - i); }, samples);
    const int q = tied(
        "Q " + corner.name, std::min(most, out * order()), [&](int i) { return out * b_.elapsed_moment(i); },
        [&](int i) { return out * i; }, since);
    if (exact) {  // straight on, P and Q cancel each other
      if (straight)
        problem_.add_to_row(problem_.add_row("corner error, corner " + corner.name, {0.0, 0.0}),
                            Affine{0.0, {{p, 1.0}, {q, -1.0}}});
      return;
    }
    const int row = problem_.add_row("corner error, corner " + corner.name, {-nlp::infinity, 1.0});
    problem_.add_product(row, 1.0, {0.0, {{p, 1.0}}}, {0.0, {{p, 1.0}}});
    problem_.add_product(row, 1.0, {0.0, {{q, 1.0}}}, {0.0, {{q, 1.0}}});
    problem_.add_product(row, 2.0 * cosine, {0.0, {{p, 1.0}}}, {0.0, {{q, 1.0}}});
  }

  /// A variable in 0 .. most that equals form(i) where chosen[i] is 1. @param largest  value of form(i)
  template <class Form, class Largest>
  int tied(const std::string& name, double most, const Form& form, const Largest& largest,
           const std::vector<int>& chosen) {
    const int variable = problem_.add_variable(name, {0.0, most});
    for (int i = 0; i < static_cast<int>(chosen.size()); ++i) {
      const int one = chosen[count(i)];
      const Affine difference = Affine{0.0, {{variable, 1.0}}} + -1.0 * form(i);
      // difference <= most (1 - one) and -difference <= largest (1 - one)
      add_below(fmt::format("{} from above, {}", name, i), difference, most, one);
      add_below(fmt::format("{} from below, {}", name, i), -1.0 * difference, largest(i), one);
    }
    return variable;
  }
  void add_below(std::string name, const Affine& form, double m, int chosen) {
    const int row = problem_.add_row(std::move(name), {-nlp::infinity, m});
    problem_.add_to_row(row, form + Affine{0.0, {{chosen, m}}});
  }

  const Task& task_;
  Choice choice_;
  QuadraticProblem& problem_;  // of the choice
  CumulativeVariables b_;
  double tap_max_;
  FormulationOptions options_;
  Affine objective_;
};

}  // namespace

Choice choice_of(const Task& task, int order) {
  const bool ideal = Response(task.machine, task.sample_period).ideal();
  if (!ideal || std::ranges::any_of(task.machine.modes, &Mode::of_axis))
    throw std::invalid_argument(
        "a whole choice knows no servo, no prefilter_taps and no residual_max_um: its rows are of the taps and of one "
        "delay each");
  if (std::ranges::any_of(task.corners, [](const TaskCorner& c) { return c.contour_max.has_value(); }))
    throw std::invalid_argument("a whole choice knows no contour_max_um: a row of it holds for one time only");
  if (const std::string reason = friction_both_ways(task); !reason.empty()) throw std::invalid_argument(reason);
  return ChoiceBuilder(task, order).build();
}

}  // namespace accdec::instances
