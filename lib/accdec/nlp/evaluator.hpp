#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <exception>
#include <optional>
#include <span>
#include <stdexcept>
#include <vector>

#include <accdec/nlp/problem.hpp>

namespace accdec::nlp {

/// Counts of calls, and seconds spent, inside a problem's own functions.
struct Counts {
  std::int64_t objective = 0, gradient = 0, rows = 0, jacobian = 0, hessian = 0, residuals = 0;
  double evaluation_time = 0.0;    ///< s
  double verification_time = 0.0;  ///< s, afterwards, of checking answers; not the solver's

  Counts& operator+=(const Counts& other);
};

/// A new best point that holds all bounds and rows, as it was met.
struct Improvement {
  std::int64_t evaluations = 0;  ///< of the objective or of the rows, whichever were more, up to and with this point
  double time = 0.0;             ///< s since the run began
  double objective = 0.0;
};

/// Why an evaluator stopped a run.
enum class Stop { none, invalid_number, evaluation_limit, time_limit, cancelled, exception };

/// Thrown by the evaluator through a C++ solver, or caught by an adapter in front of a C one; `Evaluator::stop` says
/// why.
class StopRun : public std::runtime_error {
 public:
  StopRun() : std::runtime_error("run stopped by the evaluator") {}
};

/// A problem wrapped for one run: counts and times every call, refuses numbers that are not finite, keeps the problem's
/// exceptions, enforces limits and cancellation, and remembers the best point seen that holds all bounds and rows.
///
/// Every function throws StopRun when the run must end; from then on every further call throws at once, so that no
/// library can go on (some ignore their own limits when an evaluation is NaN). Not thread-safe: one evaluator a run.
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
  // Objective and rows come in separate calls: they belong together when their points are identical.
  std::vector<double> objective_point_, rows_point_, row_values_, best_;
  double objective_value_ = 0.0, best_objective_ = infinity;
  std::vector<Improvement> history_;
};

}  // namespace accdec::nlp
