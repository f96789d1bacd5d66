// NLopt 2.7: local and global methods with and without derivatives.

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include <accdec/solvers/native_options.hpp>
#include <accdec/solvers/nlopt_problem.hpp>
#include <accdec/solvers/registration.hpp>
#include <accdec/solvers/run.hpp>

namespace accdec::solvers {
namespace {

struct Close {
  void operator()(nlopt_opt opt) const { nlopt_destroy(opt); }
};
using Handle = std::unique_ptr<std::remove_pointer_t<nlopt_opt>, Close>;

struct Algorithm {
  const char* name;
  nlopt_algorithm method;
  nlopt_algorithm inner;  // NLOPT_NUM_ALGORITHMS: none
  Capabilities can;
  NloptProblem::Rows rows = NloptProblem::Rows::constraints;
};

constexpr nlopt_algorithm no_inner = NLOPT_NUM_ALGORITHMS;

Capabilities with_gradient(bool equality_rows) {
  Capabilities can;
  can.equality_rows = equality_rows;
  return can;
}

Capabilities without_gradient() {
  Capabilities can;
  can.uses_gradient = can.uses_jacobian = false;
  return can;
}

/// A search in a box. Equality rows are impossible: random points do not hold them within a tolerance of 1e-8.
Capabilities global_search(bool rows, bool seeded) {
  Capabilities can = without_gradient();
  can.global = can.needs_finite_bounds = true;
  can.equality_rows = false;
  can.inequality_rows = rows;
  can.seeded = seeded;
  return can;
}

std::vector<Algorithm> algorithms() {
  using Rows = NloptProblem::Rows;
  Capabilities multistart = global_search(false, false);  // low-discrepancy starts, not random ones
  multistart.uses_gradient = true;
  return {
      {"nlopt-slsqp", NLOPT_LD_SLSQP, no_inner, with_gradient(true)},
      {"nlopt-mma", NLOPT_LD_MMA, no_inner, with_gradient(false)},
      {"nlopt-ccsaq", NLOPT_LD_CCSAQ, no_inner, with_gradient(false)},
      {"nlopt-cobyla", NLOPT_LN_COBYLA, no_inner, without_gradient()},
      {"nlopt-auglag-lbfgs", NLOPT_AUGLAG, NLOPT_LD_LBFGS, with_gradient(true)},
      {"nlopt-auglag-bobyqa", NLOPT_AUGLAG, NLOPT_LN_BOBYQA, without_gradient()},
      {"nlopt-isres", NLOPT_GN_ISRES, no_inner, global_search(true, true)},
      {"nlopt-esch", NLOPT_GN_ESCH, no_inner, global_search(true, true), Rows::ranking},
      {"nlopt-crs2", NLOPT_GN_CRS2_LM, no_inner, global_search(true, true), Rows::ranking},
      {"nlopt-mlsl", NLOPT_G_MLSL_LDS, NLOPT_LD_LBFGS, multistart},
  };
}

Claim claim_of(nlopt_result code) {
  switch (code) {
    case NLOPT_SUCCESS:
    case NLOPT_FTOL_REACHED:
    case NLOPT_XTOL_REACHED: return Claim::solved;
    case NLOPT_STOPVAL_REACHED: return Claim::unbounded;  // the value set below stands for minus infinity
    case NLOPT_MAXEVAL_REACHED: return Claim::evaluation_limit;
    case NLOPT_MAXTIME_REACHED: return Claim::time_limit;
    case NLOPT_ROUNDOFF_LIMITED: return Claim::acceptable;
    case NLOPT_INVALID_ARGS: return Claim::refused;
    default: return Claim::failed;
  }
}

/// Removes the one option that is a word from the others, which are numbers. It names the algorithm, for example
/// "LD_CCSAQ", that solves the dual of MMA's and CCSAQ's steps.
std::optional<nlopt_algorithm> take_dual_algorithm(std::map<std::string, std::string>& native) {
  const auto given = native.extract("dual_algorithm");
  if (!given) return std::nullopt;
  const nlopt_algorithm algorithm = nlopt_algorithm_from_string(given.mapped().c_str());
  if (algorithm < 0 || algorithm >= NLOPT_NUM_ALGORITHMS) {
    throw std::invalid_argument(fmt::format(
        "NLopt option \"dual_algorithm\" needs the name of an algorithm, as LD_MMA, LD_CCSAQ or LD_LBFGS, not \"{}\"",
        given.mapped()));
  }
  return algorithm;
}

void configure(nlopt_opt opt, const NativeOptions& native, double xtol, double ftol) {
  nlopt_set_xtol_rel(opt, native.get("xtol_rel", xtol));
  nlopt_set_ftol_rel(opt, native.get("ftol_rel", ftol));
  if (native.has("xtol_abs")) nlopt_set_xtol_abs1(opt, native.get("xtol_abs", 0.0));
  nlopt_set_ftol_abs(opt, native.get("ftol_abs", 0.0));
  if (native.has("initial_step")) nlopt_set_initial_step1(opt, native.get("initial_step", 0.0));
  if (native.has("vector_storage"))
    nlopt_set_vector_storage(opt, static_cast<unsigned>(native.get("vector_storage", 0.0)));
  if (native.has("population")) nlopt_set_population(opt, static_cast<unsigned>(native.get("population", 0.0)));
  for (const char* name : {"dual_maxeval", "inner_maxeval", "rho_init", "dual_ftol_rel"}) {
    if (native.has(name)) nlopt_set_param(opt, name, native.get(name, 0.0));
  }
}

class NloptSolver final : public Solver {
 public:
  explicit NloptSolver(Algorithm algorithm) : algorithm_(algorithm) {}
  std::string name() const override { return algorithm_.name; }
  std::string library_version() const override {
    int major = 0, minor = 0, patch = 0;
    nlopt_version(&major, &minor, &patch);
    return fmt::format("NLopt {}.{}.{}", major, minor, patch);
  }
  Capabilities capabilities() const override { return algorithm_.can; }
  std::string settings() const override {
    std::string all = fmt::format("xtol_rel = {:g} tolerance, ftol_rel = {}", xtol(1.0),
                                  conservative() ? "0" : "max(1e-15, xtol_rel / 1e6)");
    if (algorithm_.rows == NloptProblem::Rows::constraints) all += ", rows within feasibility_tolerance / 10";
    if (algorithm_.rows == NloptProblem::Rows::ranking)
      all += ", rows by ranking points that break them behind all that hold them";
    if (conservative()) all += fmt::format(", dual_maxeval = {:g}", dual_maxeval);
    if (algorithm_.inner != no_inner)
      all += "; of the method inside, xtol_rel = tolerance, ftol_rel = max(1e-15, xtol_rel / 1e6)";
    if (may_compute_on(algorithm_.method)) all += "; in a thread of its own, which is watched";
    return all;
  }

 protected:
  Result do_solve(const nlp::Problem& problem, std::span<const double> start, const Options& options) const override {
    std::map<std::string, std::string> numbers = options.native;
    const std::optional<nlopt_algorithm> dual = take_dual_algorithm(numbers);
    const NativeOptions native(
        "NLopt", numbers,
        {"dual_ftol_rel", "dual_maxeval", "ftol_abs", "ftol_rel", "initial_step", "inner_maxeval", "maxeval",
         "population", "rho_init", "vector_storage", "xtol_abs", "xtol_rel"});
    nlp::Evaluator evaluator(problem, limits_of(options));
    FreeVariables free(problem, start);
    Result result;
    result.x.assign(start.begin(), start.end());
    if (free.size() == 0) {
      judge_the_only_point(evaluator, result);
      return result;
    }
    const auto n = static_cast<unsigned>(free.size());
    // The dense workspace of SLSQP grows with n^2 and is counted in ints: NLopt would write past its end.
    if (algorithm_.method == NLOPT_LD_SLSQP && n > slsqp_most) {
      result.claim = Claim::refused;
      result.message = fmt::format("{} takes at most {} variables, this problem has {}", name(), slsqp_most, n);
      return result;
    }
    // Rows are dense, once here and once in NLopt. ISRES has a population of twenty points per variable.
    const double points = algorithm_.method == NLOPT_GN_ISRES ? 20.0 * (n + 1.0) : 0.0;
    const double size = static_cast<double>(n) + problem.num_rows();
    result.message = tables_too_large(2.0 * n * problem.num_rows() + points * size);
    if (!result.message.empty()) {
      result.claim = Claim::refused;
      return result;
    }
    const Handle opt = optimizer(n, native, options);
    if (dual) nlopt_set_param(opt.get(), "dual_algorithm", *dual);
    // A tenth of the tolerance, because the verifier recomputes the rows.
    NloptProblem callbacks(evaluator, free, opt.get(), algorithm_.rows, 0.1 * options.feasibility_tolerance);
    nlopt_result code = callbacks.attach();
    std::vector<double> x = free.restrict(start);
    const auto optimize = [&] {
      // Each thread has its own generator, which starts from the clock.
      nlopt_srand(static_cast<unsigned long>(options.seed));
      code = nlopt_optimize(opt.get(), x.data(), &result.claimed_objective);
    };
    if (code >= 0 && may_compute_on(algorithm_.method)) {
      WatchedCall watched;
      callbacks.report_to(&watched);
      if (!watched.run(optimize, options.time_limit, options.cancel))
        return abandoned(evaluator, options, std::move(result));
    } else if (code >= 0) {
      optimize();
    }
    result.x = free.expand(x.data());
    result.claim = claim_of(code);
    result.message = fmt::format("NLopt: {}", nlopt_result_to_string(code));
    if (callbacks.ranks()) undo_ranking(result);
    if (const char* words = nlopt_get_errmsg(opt.get())) result.message += fmt::format(" ({})", words);
    conclude(evaluator, result);
    return result;
  }

 private:
  static constexpr unsigned slsqp_most = 4000;

  /// An optimizer of n variables with all its settings, without the problem.
  Handle optimizer(unsigned n, const NativeOptions& native, const Options& options) const {
    Handle opt(nlopt_create(algorithm_.method, n));
    if (conservative()) nlopt_set_param(opt.get(), "dual_maxeval", dual_maxeval);
    configure(opt.get(), native, xtol(options.tolerance), ftol(options.tolerance));
    nlopt_set_stopval(opt.get(), -1e20);
    if (algorithm_.inner != no_inner) {
      const Handle inner(nlopt_create(algorithm_.inner, n));
      configure(inner.get(), native, options.tolerance, step_in_f(options.tolerance));
      nlopt_set_local_optimizer(opt.get(), inner.get());
    }
    // Searches of the whole box would use up any time limit. So they have a budget of evaluations, and the best point
    // by then is their answer. Multistart compares each new point with all earlier ones: it gets a tenth of that
    // budget.
    const bool limited = algorithm_.can.global && options.own_budget;
    const double budget = !limited ? 0.0 : algorithm_.inner == no_inner ? 10'000.0 * (n + 1.0) : 1000.0 * (n + 1.0);
    nlopt_set_maxeval(opt.get(), static_cast<int>(std::min(2e9, native.get("maxeval", budget))));
    nlopt_set_maxtime(opt.get(), options.time_limit);
    return opt;
  }

  bool conservative() const { return algorithm_.method == NLOPT_LD_MMA || algorithm_.method == NLOPT_LD_CCSAQ; }

  /// For MMA and CCSAQ. At NLopt's default of 100 000, the dual of a linear problem takes seconds per step, because it
  /// has no curvature.
  static constexpr double dual_maxeval = 2000.0;

  /// Relative steps in x decide. But for methods whose steps shrink by themselves, small steps do not mean convergence.
  /// The steps of SLSQP, and of L-BFGS in the augmented Lagrangian, also become small too early where many rows are
  /// active. But with steps at rounding (`xtol_rel` 1e-15), whole designs take SLSQP half as long again, and one of
  /// twelve shipped tasks is not designed within ten seconds.
  double xtol(double tolerance) const { return algorithm_.can.global || conservative() ? 1e-2 * tolerance : tolerance; }

  /// Steps in f reach rounding long before a first-order method has converged.
  static double step_in_f(double xtol) { return std::max(1e-15, 1e-6 * xtol); }

  /// MMA and CCSAQ would stop when f does not change, even while rows are still broken.
  double ftol(double tolerance) const { return conservative() ? 0.0 : step_in_f(xtol(tolerance)); }

  /// COBYLA may loop for ever. At a thousand variables and more, SLSQP's dense subproblems take seconds, and so does
  /// sorting the population of ISRES, which has twenty points per variable.
  static bool may_compute_on(nlopt_algorithm method) {
    return method == NLOPT_LN_COBYLA || method == NLOPT_LD_SLSQP || method == NLOPT_GN_ISRES;
  }

  static void judge_the_only_point(nlp::Evaluator& evaluator, Result& result) {
    try {
      result.claimed_objective = evaluator.objective(result.x);
      result.claim = Claim::solved;
      result.message = "every variable is fixed";
    } catch (const nlp::StopRun&) {
    }
    conclude(evaluator, result);
  }

  /// A ranking also orders points that break rows: convergence at such points is no success.
  static void undo_ranking(Result& result) {
    const std::optional<double> objective = NloptProblem::objective_of(result.claimed_objective);
    result.claimed_objective = objective.value_or(std::numeric_limits<double>::quiet_NaN());
    if (!objective && (result.claim == Claim::solved || result.claim == Claim::acceptable)) {
      result.claim = Claim::failed;
      result.message += "; no point that holds every row was found";
    }
  }

  /// The result of a run that was ended from outside: the best feasible point seen, else the start.
  static Result abandoned(const nlp::Evaluator& evaluator, const Options& options, Result result) {
    const bool cancelled = options.cancel != nullptr && options.cancel->load();
    result.claim = cancelled ? Claim::cancelled : Claim::time_limit;
    result.message = "NLopt: computed on without evaluating and had to be ended";
    result.counts = evaluator.counts();
    result.history = evaluator.history();
    if (!evaluator.best_feasible().empty()) result.x = evaluator.best_feasible();
    return result;
  }

  Algorithm algorithm_;
};

}  // namespace
}  // namespace accdec::solvers

void accdec_add_solvers(accdec::solvers::SolverList& list) {
  using namespace accdec::solvers;
  for (const Algorithm& algorithm : algorithms()) list.push_back(std::make_unique<NloptSolver>(algorithm));
}
