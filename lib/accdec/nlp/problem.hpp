#pragma once

#include <limits>
#include <span>
#include <string>
#include <vector>

namespace accdec::nlp {

inline constexpr double infinity = std::numeric_limits<double>::infinity();

/// A closed interval; -infinity / +infinity where a side is free, lower == upper for an equality or a fixed variable.
struct Bound {
  double lower = -infinity;
  double upper = infinity;
};

/// What a solver may exploit. The strongest that holds.
enum class ProblemClass {
  linear,         ///< linear objective and rows
  least_squares,  ///< objective = 1/2 |r(x)|^2 with the residual form available
  general
};

/// Position of one structural nonzero.
struct Entry {
  int row = 0;
  int column = 0;
};

/// A finite-dimensional optimisation problem
///   minimise f(x)  subject to  variable_bounds,  row_bounds.lower <= c(x) <= row_bounds.upper.
///
/// n = num_variables(), m = num_rows(). Sparsity patterns are fixed for the life of the object; duplicates are not
/// allowed. Evaluation functions are const and must be safe to call from several threads on the same object. They may
/// throw; solvers' adapters carry the exception through the C library and rethrow it. They may return NaN; the guard
/// turns that into a status.
class Problem {
 public:
  virtual ~Problem() = default;

  virtual std::string name() const { return "problem"; }
  virtual int num_variables() const = 0;
  virtual int num_rows() const = 0;
  virtual Bound variable_bound(int i) const = 0;
  virtual Bound row_bound(int i) const = 0;
  virtual std::string variable_name(int i) const { return std::string("x").append(std::to_string(i + 1)); }
  virtual std::string row_name(int i) const { return std::string("c").append(std::to_string(i + 1)); }
  virtual ProblemClass problem_class() const { return ProblemClass::general; }

  /// f(x). 0 for a pure feasibility problem.
  virtual double objective(std::span<const double> x) const = 0;
  /// Dense gradient, size n, every entry written.
  virtual void gradient(std::span<const double> x, std::span<double> g) const = 0;
  /// c(x), size m.
  virtual void rows(std::span<const double> x, std::span<double> c) const = 0;
  /// Pattern of dc/dx; row in 0..m-1, column in 0..n-1.
  virtual const std::vector<Entry>& jacobian_pattern() const = 0;
  /// Values in the order of the pattern.
  virtual void jacobian(std::span<const double> x, std::span<double> values) const = 0;

  /// Second derivatives; when false, solvers fall back on quasi-Newton and the two functions below are never called.
  virtual bool has_hessian() const { return true; }
  /// Pattern of the lower triangle (row >= column) of objective_factor * d2f + sum_i multipliers_i * d2c_i.
  virtual const std::vector<Entry>& hessian_pattern() const = 0;
  virtual void hessian(std::span<const double> x, double objective_factor, std::span<const double> multipliers,
                       std::span<double> values) const = 0;

  /// Residual form, f = 1/2 sum r_i^2; 0 where there is none. The Jacobian is dense, row-major num_residuals x n.
  virtual int num_residuals() const { return 0; }
  virtual void residuals(std::span<const double> /*x*/, std::span<double> /*r*/) const {}
  virtual void residual_jacobian(std::span<const double> /*x*/, std::span<double> /*values*/) const {}
};

}  // namespace accdec::nlp
