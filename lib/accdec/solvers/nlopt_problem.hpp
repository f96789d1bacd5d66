#pragma once

#include <cmath>
#include <optional>
#include <vector>

#include <nlopt.h>

#include <accdec/problem.hpp>
#include <accdec/solvers/free_variables.hpp>
#include <accdec/solvers/watched_call.hpp>

namespace accdec::solvers {

/// A problem as NLopt's C callbacks see it. The exception StopRun never passes through NLopt: the callback asks NLopt
/// to stop and returns a harmless number. COBYLA loops for ever on NaN, and an exception would be lost in C.
class NloptProblem {
 public:
  /// How rows reach the algorithm.
  enum class Rows {
    constraints,  ///< as NLopt constraints c <= 0 and c = 0
    ranking  ///< inside the objective, for algorithms that only compare values: points that hold all rows are better
             ///< than all others and ordered by the objective, the others by their violation
  };

  NloptProblem(nlp::Evaluator& evaluator, FreeVariables& free, nlopt_opt opt, Rows rows, double row_tolerance);

  /// Every callback reports to this call, for algorithms run as a watched call.
  void report_to(WatchedCall* call) { call_ = call; }

  /// Passes objective, bounds and rows to the nlopt_opt.
  nlopt_result attach();

  /// Whether the objective that NLopt sees is a ranking; it is one only if there are rows.
  bool ranks() const { return rows_ == Rows::ranking && !values_.empty(); }

  /// The objective of a point with this rank; empty if the point breaks a row.
  static std::optional<double> objective_of(double rank);

 private:
  struct Side {
    int row;
    double sign, bound;  // sign * (c - bound) <= 0 or = 0
  };
  static double objective(unsigned n, const double* x, double* grad, void* self);
  template <auto sides>  // which member
  static void constraints(unsigned m, double* result, unsigned n, const double* x, double* grad, void* self);

  double evaluate(const double* x, double* grad);
  void evaluate_rows(const std::vector<Side>& sides, double* result, const double* x, double* grad);
  double ranked(double f, const std::vector<double>& x);

  nlp::Evaluator& evaluator_;
  FreeVariables& free_;
  nlopt_opt opt_;
  WatchedCall* call_ = nullptr;
  Rows rows_;
  double tolerance_;
  std::vector<Side> inequalities_, equalities_;
  std::vector<double> gradient_, values_, values_point_, jacobian_, jacobian_point_;
};

}  // namespace accdec::solvers
