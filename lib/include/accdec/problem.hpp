// Finite-dimensional problems for solvers, and their evaluation with counters.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <exception>
#include <limits>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace accdec::nlp {

inline constexpr double infinity = std::numeric_limits<double>::infinity();

/// A closed interval; -infinity / +infinity where a side is free, lower == upper for an equality or a fixed variable.
struct Bound {
  double lower = -infinity;
  double upper = infinity;
};

/// The structure that a solver may use: the strongest that holds.
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
/// throw; the solvers' adapters pass the exception through the C library and rethrow it. They may return NaN; the guard
/// turns that into a status.
class Problem {
 public:
  virtual ~Problem() = default;

  virtual std::string name() const { return "problem"; }
  virtual int num_variables() const = 0;
  virtual int num_rows() const = 0;
  virtual Bound variable_bound(int i) const = 0;
  virtual Bound row_bound(int i) const = 0;
  /// Whether a variable must be whole.
  virtual bool is_integer(int /*i*/) const { return false; }
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

/// Counts of calls, and seconds spent, inside a problem's own functions.
struct Counts {
  std::int64_t objective = 0, gradient = 0, rows = 0, jacobian = 0, hessian = 0, residuals = 0;
  double evaluation_time = 0.0;    ///< s
  double verification_time = 0.0;  ///< s, for checking answers afterwards; not the solver's

  Counts& operator+=(const Counts& other);
};

/// A new best point that holds all bounds and rows, as it was met.
struct Improvement {
  std::int64_t evaluations = 0;  ///< of the objective or of the rows, whichever were more, up to and including this
                                 ///< point
  double time = 0.0;             ///< s since the run began
  double objective = 0.0;
};

/// Why an evaluator stopped a run.
enum class Stop { none, invalid_number, evaluation_limit, time_limit, cancelled, exception };

/// Thrown by the evaluator. It passes through a C++ solver; before a C one an adapter catches it. `Evaluator::stop`
/// gives the reason.
class StopRun : public std::runtime_error {
 public:
  StopRun() : std::runtime_error("run stopped by the evaluator") {}
};

/// A problem wrapped for one run. It counts and times every call, refuses numbers that are not finite, and keeps the
/// problem's exceptions. It enforces limits and cancellation, and it remembers the best point seen that holds all
/// bounds and rows.
///
/// Every function throws StopRun when the run must end. From then on every call throws at once, so that no library can
/// continue: some ignore their own limits when an evaluation is NaN. Not thread-safe: one evaluator a run.
class Evaluator {
 public:
  struct Limits {
    std::int64_t evaluations = 1'000'000;  ///< of the objective
    double time = 60.0;                    ///< s since construction
    const std::atomic<bool>* cancel = nullptr;
    double feasibility_tolerance = 1e-8;  ///< absolute, for the best point kept
  };

  Evaluator(const Problem& problem, Limits limits);

  const Problem& problem() const { return problem_; }
  double objective(std::span<const double> x);
  void gradient(std::span<const double> x, std::span<double> g);
  void rows(std::span<const double> x, std::span<double> c);
  void jacobian(std::span<const double> x, std::span<double> values);
  void hessian(std::span<const double> x, double objective_factor, std::span<const double> multipliers,
               std::span<double> values);
  void residuals(std::span<const double> x, std::span<double> r);
  void residual_jacobian(std::span<const double> x, std::span<double> values);

  /// Polls limits and cancellation without an evaluation. @throws StopRun
  void poll();

  const Counts& counts() const { return counts_; }
  Stop stop() const { return stop_; }
  std::exception_ptr exception() const { return exception_; }

  /// Best point seen whose bounds and rows hold; empty when none did.
  const std::vector<double>& best_feasible() const { return best_; }
  double best_objective() const { return best_objective_; }
  double feasibility_tolerance() const { return limits_.feasibility_tolerance; }
  /// Every improvement of it in order.
  const std::vector<Improvement>& history() const { return history_; }

 private:
  template <class Call>
  void guarded(std::int64_t& count, Call call);
  [[noreturn]] void end(Stop why);
  void require_finite(std::span<const double> values);
  void consider();

  const Problem& problem_;
  Limits limits_;
  std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
  Counts counts_;
  Stop stop_ = Stop::none;
  std::exception_ptr exception_;
  // Objective and rows are evaluated in separate calls: they belong together if their points are identical.
  std::vector<double> objective_point_, rows_point_, row_values_, best_;
  double objective_value_ = 0.0, best_objective_ = infinity;
  std::vector<Improvement> history_;
};

}  // namespace accdec::nlp
