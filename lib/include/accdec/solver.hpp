// The one interface of all solvers, and their registry.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <accdec/problem.hpp>

namespace accdec::solvers {

/// Properties of one algorithm of one library; printed by `accdec solvers`.
struct Capabilities {
  bool linear_only = false;          ///< accepts ProblemClass::linear alone
  bool bounds = true;                ///< finite variable bounds
  bool inequality_rows = true;       ///< rows with lower < upper
  bool equality_rows = true;         ///< rows with lower == upper
  bool needs_finite_bounds = false;  ///< every variable needs both bounds (global and population methods)
  bool needs_residuals = false;      ///< objective must have the residual form or be reducible to it
  bool uses_gradient = true;
  bool uses_jacobian = true;
  bool uses_hessian = false;
  bool global = false;    ///< searches the whole box; false: local
  bool seeded = false;    ///< random, reproducible by Options::seed; false: deterministic
  bool integers = false;  ///< variables that must be whole
};

/// A library's statement about its own run (claimed), and the verifier's finding on the returned point (verified).
enum class Claim {
  solved,      ///< the library's own success
  acceptable,  ///< success at a looser tolerance, or stopped by rounding
  infeasible,  ///< infeasible: proved for linear problems, locally infeasible otherwise
  unbounded,   ///< unbounded or diverged
  evaluation_limit,
  time_limit,
  cancelled,
  invalid_number,  ///< NaN or infinity from an evaluation
  failed,          ///< anything else the library reported
  refused          ///< not run: capability, sizes or bounds; see message
};
std::string_view to_string(Claim claim);

enum class Verdict {
  optimal,     ///< feasible and first-order stationary within tolerance
  feasible,    ///< feasible, stationarity not shown
  infeasible,  ///< some bound or row violated beyond tolerance
  none         ///< no finite point to judge
};
std::string_view to_string(Verdict verdict);

/// Recomputed on the returned point by code that the solver does not share. Violations are absolute.
struct Verification {
  Verdict verdict = Verdict::none;
  double objective = 0.0;
  double row_violation = 0.0;
  double bound_violation = 0.0;
  std::string worst;  ///< name of the worst row or variable, empty when nothing is violated
  double stationarity =
      0.0;  ///< scaled infinity norm of the projected Lagrangian gradient with the best multipliers found
  double complementarity = 0.0;  ///< largest |multiplier * slack|
};

struct Options {
  double tolerance = 1e-8;                    ///< relative optimality tolerance asked of the library
  double feasibility_tolerance = 1e-8;        ///< absolute, on rows as given; also the verifier's
  double time_limit = 60.0;                   ///< s, wall clock
  std::int64_t evaluation_limit = 1'000'000;  ///< objective evaluations
  bool own_budget = true;  ///< a method may end sooner, at a budget of evaluations, iterations or rounds of its own
  std::uint64_t seed = 1;
  std::function<void(const std::string&)> log;  ///< nothing is logged when empty
  const std::atomic<bool>* cancel = nullptr;    ///< polled at every evaluation
  std::map<std::string, std::string> native;    ///< the library's own options; an unknown name is an error
};

/// Measured outside the library.
using Counts = nlp::Counts;

struct Result {
  std::vector<double>
      x;  ///< the point returned; after a stop by limits or cancellation, the best verified-feasible point seen
  Claim claim = Claim::failed;
  Verification verification;
  std::vector<double> row_multipliers;  ///< as the library gave them, may be empty; sign: L = f + sum multipliers * c
  double claimed_objective = 0.0;
  Counts counts;
  std::vector<nlp::Improvement>
      history;             ///< every new best point that held all bounds and rows within the feasibility tolerance
  double wall_time = 0.0;  ///< s, the solve alone
  std::string message;     ///< the library's words, warnings, reasons for refusal
};

/// One algorithm of one library. Const and stateless: safe to call from several threads at once.
class Solver {
 public:
  virtual ~Solver() = default;
  virtual std::string name() const = 0;             ///< registry name, e.g. "nlopt-slsqp"
  virtual std::string library_version() const = 0;  ///< e.g. "NLopt 2.7.1"
  virtual Capabilities capabilities() const = 0;
  /// Settings that differ from the library's defaults, besides limits of time and evaluations: one line of its options.
  virtual std::string settings() const { return ""; }

  /// Solves a problem in these steps. It checks capability, sizes and bounds once, and refuses with the reason before
  /// any evaluation. It projects the start into the bounds and says so. It guards and counts every evaluation, runs
  /// `do_solve`, and verifies the returned point.
  /// @throws std::invalid_argument for an unknown native option; whatever the problem's own functions threw.
  Result solve(const nlp::Problem& problem, std::span<const double> start, const Options& options = {}) const;

 protected:
  virtual Result do_solve(const nlp::Problem& problem, std::span<const double> start, const Options& options) const = 0;
};

/// All registered algorithms in a fixed order. The first call loads the solver libraries.
const std::vector<std::unique_ptr<Solver>>& registry();
/// Modules of solver libraries that the first call of `registry` could not load, and why.
const std::map<std::string, std::string>& missing_modules();
/// Names and versions of the solver libraries that this was built with. Loads none.
std::vector<std::pair<std::string, std::string>> libraries();
/// Adds an algorithm from outside the library. Do not call it while another thread solves or looks up a solver.
/// @throws std::invalid_argument if the name is taken.
void register_solver(std::unique_ptr<Solver> solver);
/// @throws std::invalid_argument listing the known names; std::runtime_error if the solver's library is missing.
const Solver& find_solver(std::string_view name);
/// Empty if the algorithm accepts the problem; otherwise the property it lacks.
std::string reason_to_refuse(const Solver& solver, const nlp::Problem& problem);

}  // namespace accdec::solvers
