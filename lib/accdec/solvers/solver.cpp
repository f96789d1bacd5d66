#include <algorithm>
#include <chrono>
#include <cmath>

#include <fmt/format.h>

#include <accdec/files.hpp>
#include <accdec/nlp/kkt.hpp>
#include <accdec/nlp/violation.hpp>
#include <accdec/solver.hpp>

namespace accdec::solvers {

std::string_view to_string(Claim claim) {
  switch (claim) {
    case Claim::solved: return "solved";
    case Claim::acceptable: return "acceptable";
    case Claim::infeasible: return "infeasible";
    case Claim::unbounded: return "unbounded";
    case Claim::evaluation_limit: return "evaluation limit";
    case Claim::time_limit: return "time limit";
    case Claim::cancelled: return "cancelled";
    case Claim::invalid_number: return "invalid number";
    case Claim::failed: return "failed";
    case Claim::refused: return "refused";
  }
  return "?";
}

std::string_view to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::optimal: return "optimal";
    case Verdict::feasible: return "feasible";
    case Verdict::infeasible: return "infeasible";
    case Verdict::none: return "none";
  }
  return "?";
}

namespace {

bool has_integers(const nlp::Problem& problem) {
  for (int i = 0; i < problem.num_variables(); ++i) {
    if (problem.is_integer(i)) return true;
  }
  return false;
}

}  // namespace

std::string reason_to_refuse(const Solver& solver, const nlp::Problem& problem) {
  const Capabilities can = solver.capabilities();
  const auto lacks = [&](const char* what) {
    return fmt::format("{} does not accept this problem: {}", solver.name(), what);
  };
  if (can.linear_only && problem.problem_class() != nlp::ProblemClass::linear) return lacks("it is not linear");
  if (can.needs_residuals && problem.num_residuals() == 0 &&
      problem.problem_class() == nlp::ProblemClass::least_squares) {
    return lacks("it has no residual form");
  }
  if (!can.integers && has_integers(problem)) return lacks("it has variables that must be whole");
  bool equality = false, inequality = false;
  for (int r = 0; r < problem.num_rows(); ++r) {
    const nlp::Bound b = problem.row_bound(r);
    (b.lower == b.upper ? equality : inequality) = true;
  }
  if (equality && !can.equality_rows) return lacks("it has equality rows");
  if (inequality && !can.inequality_rows) return lacks("it has inequality rows");
  for (int i = 0; i < problem.num_variables(); ++i) {
    const nlp::Bound b = problem.variable_bound(i);
    const bool lower = std::isfinite(b.lower), upper = std::isfinite(b.upper);
    if ((lower || upper) && !can.bounds) return lacks("it has bounds on variables");
    if ((!lower || !upper) && can.needs_finite_bounds) {
      return lacks(fmt::format("variable {} is not bounded on both sides", problem.variable_name(i)).c_str());
    }
  }
  return {};
}

namespace {

/// The first thing wrong with sizes and bounds; empty when all is well.
std::string malformed(const nlp::Problem& problem, std::span<const double> start) {
  const int n = problem.num_variables(), m = problem.num_rows();
  if (n < 0 || m < 0) return "negative size";
  if (static_cast<int>(start.size()) != n)
    return fmt::format("the start has {} entries, the problem {} variables", start.size(), n);
  const auto crossed = [](nlp::Bound b) {
    return !(b.lower <= b.upper) || b.lower == nlp::infinity || b.upper == -nlp::infinity;
  };
  for (int i = 0; i < n; ++i) {
    const nlp::Bound b = problem.variable_bound(i);
    if (crossed(b))
      return fmt::format("bounds of variable {} are crossed: {} > {}", problem.variable_name(i), b.lower, b.upper);
  }
  for (int r = 0; r < m; ++r) {
    const nlp::Bound b = problem.row_bound(r);
    if (crossed(b)) return fmt::format("bounds of row {} are crossed: {} > {}", problem.row_name(r), b.lower, b.upper);
  }
  const auto outside = [&](const nlp::Entry& e, int rows) {
    return e.row < 0 || e.row >= rows || e.column < 0 || e.column >= n;
  };
  for (const nlp::Entry& e : problem.jacobian_pattern()) {
    if (outside(e, m)) return fmt::format("Jacobian entry ({}, {}) is outside {} x {}", e.row, e.column, m, n);
  }
  if (problem.has_hessian()) {
    for (const nlp::Entry& e : problem.hessian_pattern()) {
      if (outside(e, n) || e.row < e.column)
        return fmt::format("Hessian entry ({}, {}) is not in the lower triangle", e.row, e.column);
    }
  }
  return {};
}

using Clock = std::chrono::steady_clock;

Verification verified(const nlp::Problem& problem, const Result& result, const Options& options) {
  const nlp::KktReport kkt = nlp::check_kkt(problem, result.x, result.row_multipliers);
  Verification v;
  v.objective = kkt.objective;
  v.row_violation = kkt.row_violation;
  v.bound_violation = kkt.bound_violation;
  v.worst = kkt.worst;
  v.stationarity = kkt.stationarity;
  v.complementarity = kkt.complementarity;
  if (!kkt.finite) {
    v.verdict = Verdict::none;
  } else if (std::max(kkt.row_violation, kkt.bound_violation) > options.feasibility_tolerance) {
    v.verdict = Verdict::infeasible;
  } else {
    const bool stationary = std::max(kkt.stationarity, kkt.complementarity) <= std::max(1e-5, 10.0 * options.tolerance);
    v.verdict = stationary ? Verdict::optimal : Verdict::feasible;
  }
  return v;
}

/// With whole variables no conditions on derivatives hold, so only rows, bounds and whole numbers are checked.
Verification verified_whole(const nlp::Problem& problem, const std::vector<double>& x, const Options& options) {
  Verification v;
  if (!std::all_of(x.begin(), x.end(), [](double value) { return std::isfinite(value); })) return v;
  v.objective = problem.objective(x);
  v.row_violation = nlp::largest_violation(problem, x);
  for (int i = 0; i < problem.num_variables(); ++i) {
    const double value = x[static_cast<std::size_t>(i)];
    if (problem.is_integer(i)) v.bound_violation = std::max(v.bound_violation, std::abs(value - std::round(value)));
  }
  const bool holds = std::max(v.row_violation, v.bound_violation) <= options.feasibility_tolerance;
  v.verdict = holds ? Verdict::feasible : Verdict::infeasible;
  return v;
}

}  // namespace

Result Solver::solve(const nlp::Problem& problem, std::span<const double> start, const Options& options) const {
  Result refused;
  refused.claim = Claim::refused;
  refused.message = malformed(problem, start);
  if (refused.message.empty()) refused.message = reason_to_refuse(*this, problem);
  if (!refused.message.empty()) return refused;

  std::vector<double> projected(start.begin(), start.end());
  int moved = 0;
  for (std::size_t i = 0; i < projected.size(); ++i) {
    const nlp::Bound b = problem.variable_bound(static_cast<int>(i));
    const double inside = std::clamp(projected[i], b.lower, b.upper);
    if (inside != projected[i]) ++moved;
    projected[i] = inside;
  }

  const auto began = Clock::now();
  Result result = do_solve(problem, projected, options);
  const auto ended = Clock::now();
  // A program is timed by itself, without what writes its problem and reads its answer.
  if (result.wall_time == 0.0) result.wall_time = std::chrono::duration<double>(ended - began).count();
  if (moved > 0) {
    result.message +=
        fmt::format("{}start projected into the bounds ({} variables)", result.message.empty() ? "" : "; ", moved);
  }

  result.verification =
      has_integers(problem) ? verified_whole(problem, result.x, options) : verified(problem, result, options);
  result.counts.verification_time = seconds_since(ended);
  return result;
}

}  // namespace accdec::solvers
