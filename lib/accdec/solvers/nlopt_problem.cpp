#include <algorithm>

#include <accdec/solvers/nlopt_problem.hpp>

namespace accdec::solvers {

using nlp::StopRun;

NloptProblem::NloptProblem(nlp::Evaluator& evaluator, FreeVariables& free, nlopt_opt opt, Rows rows,
                           double row_tolerance)
    : evaluator_(evaluator), free_(free), opt_(opt), rows_(rows), tolerance_(row_tolerance) {
  const nlp::Problem& problem = evaluator.problem();
  gradient_.resize(static_cast<std::size_t>(problem.num_variables()));
  values_.resize(static_cast<std::size_t>(problem.num_rows()));
  jacobian_.resize(problem.jacobian_pattern().size());
  for (int r = 0; r < problem.num_rows(); ++r) {
    const nlp::Bound b = problem.row_bound(r);
    if (b.lower == b.upper) {
      equalities_.push_back({r, 1.0, b.lower});
      continue;
    }
    if (std::isfinite(b.upper)) inequalities_.push_back({r, 1.0, b.upper});
    if (std::isfinite(b.lower)) inequalities_.push_back({r, -1.0, b.lower});
  }
}

nlopt_result NloptProblem::attach() {
  nlopt_set_min_objective(opt_, objective, this);
  std::vector<double> lower, upper;
  for (std::size_t i = 0; i < free_.size(); ++i) {
    lower.push_back(free_.bound(i).lower);
    upper.push_back(free_.bound(i).upper);
  }
  nlopt_set_lower_bounds(opt_, lower.data());
  nlopt_set_upper_bounds(opt_, upper.data());
  if (rows_ == Rows::ranking) return NLOPT_SUCCESS;
  const auto add = [&](const std::vector<Side>& sides, auto nlopt_add, auto callback) {
    if (sides.empty()) return NLOPT_SUCCESS;
    const std::vector<double> tolerances(sides.size(), tolerance_);
    return nlopt_add(opt_, static_cast<unsigned>(sides.size()), callback, this, tolerances.data());
  };
  const nlopt_result first =
      add(inequalities_, nlopt_add_inequality_mconstraint, constraints<&NloptProblem::inequalities_>);
  if (first < 0) return first;
  return add(equalities_, nlopt_add_equality_mconstraint, constraints<&NloptProblem::equalities_>);
}

double NloptProblem::objective(unsigned n, const double* x, double* grad, void* self) {
  auto& run = *static_cast<NloptProblem*>(self);
  const WatchedCall::Callback callback(run.call_);
  try {
    return run.evaluate(x, grad);
  } catch (const StopRun&) {
    nlopt_force_stop(run.opt_);
    if (grad != nullptr) std::fill_n(grad, n, 0.0);
    return 0.0;
  }
}

template <auto sides>
void NloptProblem::constraints(unsigned m, double* result, unsigned n, const double* x, double* grad, void* self) {
  auto& run = *static_cast<NloptProblem*>(self);
  const WatchedCall::Callback callback(run.call_);
  try {
    run.evaluate_rows(run.*sides, result, x, grad);
  } catch (const StopRun&) {
    nlopt_force_stop(run.opt_);
    std::fill_n(result, m, 0.0);
    if (grad != nullptr) std::fill_n(grad, static_cast<std::size_t>(m) * n, 0.0);
  }
}

double NloptProblem::evaluate(const double* x, double* grad) {
  const std::vector<double>& full = free_.expand(x);
  const double f = evaluator_.objective(full);
  if (grad != nullptr) {
    evaluator_.gradient(full, gradient_);
    free_.restrict(gradient_, grad);
  }
  return ranks() ? ranked(f, full) : f;
}

void NloptProblem::evaluate_rows(const std::vector<Side>& sides, double* result, const double* x, double* grad) {
  // Inequalities and equalities are asked in two calls at the same point: the rows are evaluated once.
  const std::vector<double>& full = free_.expand(x);
  if (values_point_ != full) {
    evaluator_.rows(full, values_);
    values_point_ = full;
  }
  for (std::size_t i = 0; i < sides.size(); ++i) {
    result[i] = sides[i].sign * (values_[static_cast<std::size_t>(sides[i].row)] - sides[i].bound);
  }
  if (grad == nullptr) return;
  if (jacobian_point_ != full) {
    evaluator_.jacobian(full, jacobian_);
    jacobian_point_ = full;
  }
  std::fill_n(grad, sides.size() * free_.size(), 0.0);
  const std::vector<nlp::Entry>& pattern = evaluator_.problem().jacobian_pattern();
  std::vector<int> first(values_.size() + 1, -1);  // sides stand in the order of their rows, at most two a row
  for (std::size_t i = sides.size(); i-- > 0;) first[static_cast<std::size_t>(sides[i].row)] = static_cast<int>(i);
  for (std::size_t e = 0; e < pattern.size(); ++e) {
    const int column = free_.position(pattern[e].column);
    const int side = first[static_cast<std::size_t>(pattern[e].row)];
    if (column < 0 || side < 0) continue;
    for (auto i = static_cast<std::size_t>(side); i < sides.size() && sides[i].row == pattern[e].row; ++i) {
      grad[i * free_.size() + static_cast<std::size_t>(column)] += sides[i].sign * jacobian_[e];
    }
  }
}

double NloptProblem::ranked(double f, const std::vector<double>& x) {
  evaluator_.rows(x, values_);
  double violation = 0.0;
  for (const Side& s : inequalities_) {
    violation = std::max(violation, s.sign * (values_[static_cast<std::size_t>(s.row)] - s.bound));
  }
  for (const Side& s : equalities_)
    violation = std::max(violation, std::abs(values_[static_cast<std::size_t>(s.row)] - s.bound));
  // Monotone in f and within (-1, 1), so every violation ranks behind it without loss of digits in a large offset.
  return violation > tolerance_ ? 2.0 + violation : f / (1.0 + std::abs(f));
}

std::optional<double> NloptProblem::objective_of(double rank) {
  if (rank > 1.0) return std::nullopt;
  return rank / (1.0 - std::abs(rank));
}

}  // namespace accdec::solvers
