#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <conformance/second_order.hpp>

#include <accdec/problem.hpp>

namespace accdec::testing {

using Variables = std::vector<Second>;
using Formula = std::function<Second(const Variables&)>;

/// A small problem written as formulas; dense patterns, exact derivatives.
class FormulaProblem : public nlp::Problem {
 public:
  struct Row {
    nlp::Bound bound;
    Formula formula;
  };
  FormulaProblem(std::string name, std::vector<nlp::Bound> bounds, Formula objective, std::vector<Row> rows,
                 nlp::ProblemClass problem_class = nlp::ProblemClass::general, std::vector<Formula> residuals = {});

  std::string name() const override { return name_; }
  int num_variables() const override { return static_cast<int>(bounds_.size()); }
  int num_rows() const override { return static_cast<int>(rows_.size()); }
  nlp::Bound variable_bound(int i) const override { return bounds_[static_cast<std::size_t>(i)]; }
  nlp::Bound row_bound(int i) const override { return rows_[static_cast<std::size_t>(i)].bound; }
  nlp::ProblemClass problem_class() const override { return class_; }
  double objective(std::span<const double> x) const override;
  void gradient(std::span<const double> x, std::span<double> g) const override;
  void rows(std::span<const double> x, std::span<double> c) const override;
  const std::vector<nlp::Entry>& jacobian_pattern() const override { return jacobian_pattern_; }
  void jacobian(std::span<const double> x, std::span<double> values) const override;
  const std::vector<nlp::Entry>& hessian_pattern() const override { return hessian_pattern_; }
  void hessian(std::span<const double> x, double objective_factor, std::span<const double> multipliers,
               std::span<double> values) const override;
  int num_residuals() const override { return static_cast<int>(residuals_.size()); }
  void residuals(std::span<const double> x, std::span<double> r) const override;
  void residual_jacobian(std::span<const double> x, std::span<double> values) const override;

 protected:
  std::vector<nlp::Bound> bounds_;
  std::vector<Row> rows_;

 private:
  Variables lift(std::span<const double> x) const;
  std::string name_;
  Formula objective_;
  nlp::ProblemClass class_;
  std::vector<Formula> residuals_;
  std::vector<nlp::Entry> jacobian_pattern_, hessian_pattern_;
};

/// A problem with a known answer.
struct Case {
  FormulaProblem problem;
  std::vector<double> start;
  double optimum = 0.0;
  std::vector<double> solution = {};         ///< a minimiser
  std::optional<double> local_optimum = {};  ///< another local minimum, right for a local method
  double tolerance = 1e-6;                   ///< on the objective, relative to max(1, |optimum|)
  bool regular = true;                       ///< a constraint qualification holds, so a minimiser is a KKT point
};

/// Cases from Hock and Schittkowski, Test Examples for Nonlinear Programming Codes (1981), by their numbers, and filter
/// problems in closed form. "In a box" means with added finite bounds that are inactive at the minimiser, for methods
/// that search a box.
const std::vector<Case>& cases();

}  // namespace accdec::testing
