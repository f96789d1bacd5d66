// Bonmin 1.8: branch and bound over Ipopt (B-BB), and outer approximation by Cbc (B-OA). Its two other ways, B-QG and
// B-Hyb, call worse designs optimal with Debian's Cbc 2.10, or end in an assertion of Cbc. So they are not offered.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <random>
#include <utility>

#include <BonBonminSetup.hpp>
#include <BonCbc.hpp>
#include <CoinError.hpp>
#include <fmt/format.h>

#include <accdec/files.hpp>
#include <accdec/solvers/ipopt_problem.hpp>
#include <accdec/solvers/module.hpp>
#include <accdec/solvers/registration.hpp>
#include <accdec/solvers/run.hpp>

namespace accdec::solvers {
namespace {

using nlp::Evaluator;

/// Adds the whole variables, and which rows are linear. Bonmin's outer approximations take a linear row for its slopes
/// alone, as AMPL's have no constants. So constants go to the bounds here.
class Adapter : public IpoptProblem<Bonmin::TMINLP> {
 public:
  Adapter(Evaluator& evaluator, std::span<const double> start) : IpoptProblem(evaluator, start) {
    find_linear_rows(start);
  }

  bool get_bounds_info(Ipopt::Index n, double* xl, double* xu, Ipopt::Index m, double* cl, double* cu) override {
    if (!IpoptProblem::get_bounds_info(n, xl, xu, m, cl, cu)) return false;
    subtract_constants(m, cl);
    subtract_constants(m, cu);
    return true;
  }
  bool eval_g(Ipopt::Index n, const double* x, bool is_new, Ipopt::Index m, double* c) override {
    if (!IpoptProblem::eval_g(n, x, is_new, m, c)) return false;
    subtract_constants(m, c);
    return true;
  }
  bool get_variables_types(Ipopt::Index n, VariableType* types) override {
    for (int i = 0; i < n; ++i) {
      const nlp::Bound b = problem().variable_bound(i);
      const bool binary = b.lower == 0.0 && b.upper == 1.0;
      types[i] = !problem().is_integer(i) ? CONTINUOUS : binary ? BINARY : INTEGER;
    }
    return true;
  }
  bool get_variables_linearity(Ipopt::Index n, Ipopt::TNLP::LinearityType* types) override {
    std::fill(types, types + n, Ipopt::TNLP::NON_LINEAR);
    for (int i = 0; i < n; ++i) {
      if (problem().is_integer(i) && !curved_[static_cast<std::size_t>(i)]) types[i] = Ipopt::TNLP::LINEAR;
    }
    return true;
  }
  bool get_constraints_linearity(Ipopt::Index m, Ipopt::TNLP::LinearityType* types) override {
    for (int r = 0; r < m; ++r)
      types[r] = linear_[static_cast<std::size_t>(r)] ? Ipopt::TNLP::LINEAR : Ipopt::TNLP::NON_LINEAR;
    return true;
  }
  void finalize_solution(SolverReturn, Ipopt::Index, const double*, double) override {}
  const BranchingInfo* branchingInfo() const override { return nullptr; }
  const SosInfo* sosConstraints() const override { return nullptr; }

 private:
  /// A row is linear if all its second derivatives are exactly zero at the start and at two points drawn in the box.
  void find_linear_rows(std::span<const double> start) {
    const auto n = static_cast<std::size_t>(problem().num_variables()),
               m = static_cast<std::size_t>(problem().num_rows());
    const std::vector<nlp::Entry>& pattern = problem().hessian_pattern();
    linear_.assign(m, problem().has_hessian());
    curved_.assign(n, !problem().has_hessian());
    constants_.assign(m, 0.0);
    if (!problem().has_hessian()) return;
    std::mt19937_64 random(1);
    std::vector<double> x(start.begin(), start.end()), values(pattern.size()), multipliers(m, 0.0);
    for (int point = 0; point < 3; ++point) {
      for (std::size_t r = 0; r < m; ++r) {
        multipliers[r] = 1.0;
        problem().hessian(x, 0.0, multipliers, values);
        multipliers[r] = 0.0;
        for (std::size_t e = 0; e < values.size(); ++e) {
          if (values[e] == 0.0) continue;
          linear_[r] = false;
          curved_[static_cast<std::size_t>(pattern[e].row)] = curved_[static_cast<std::size_t>(pattern[e].column)] =
              true;
        }
      }
      for (std::size_t i = 0; i < n; ++i) {
        const nlp::Bound b = problem().variable_bound(static_cast<int>(i));
        const double low = std::max(b.lower, -10.0), high = std::max(low, std::min(b.upper, 10.0));
        x[i] = low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
      }
    }
    problem().rows(std::vector<double>(n, 0.0), constants_);
    for (std::size_t r = 0; r < m; ++r) {
      linear_[r] = linear_[r] && std::isfinite(constants_[r]);
      if (!linear_[r]) constants_[r] = 0.0;
    }
  }

  /// Takes the constants of linear rows from their values or bounds. A bound that is absent stays so.
  void subtract_constants(Ipopt::Index m, double* values) const {
    for (int r = 0; r < m; ++r) {
      if (std::abs(values[r]) < 1e19) values[r] -= constants_[static_cast<std::size_t>(r)];
    }
  }

  std::vector<bool> linear_, curved_;
  std::vector<double> constants_;  ///< of rows; 0 if a row is not linear
};

Claim claim_of(Bonmin::Bab::MipStatuses status, bool late) {
  switch (status) {
    case Bonmin::Bab::FeasibleOptimal: return Claim::solved;
    case Bonmin::Bab::ProvenInfeasible: return Claim::infeasible;
    case Bonmin::Bab::UnboundedOrInfeasible: return Claim::infeasible;
    case Bonmin::Bab::Feasible: return late ? Claim::time_limit : Claim::acceptable;
    default: return late ? Claim::time_limit : Claim::failed;
  }
}

class BonminSolver final : public Solver {
 public:
  BonminSolver(std::string name, std::string algorithm) : name_(std::move(name)), algorithm_(std::move(algorithm)) {}
  std::string name() const override { return name_; }
  std::string library_version() const override { return "Bonmin " ACCDEC_BONMIN_VERSION; }
  Capabilities capabilities() const override {
    Capabilities can;
    can.uses_hessian = can.integers = true;
    return can;
  }
  std::string settings() const override {
    return "algorithm = " + algorithm_ +
           ", tol = tolerance, constr_viol_tol = feasibility_tolerance / 10, allowable_gap = 5e-4, "
           "allowable_fraction_gap = 0, bound_relax_factor = 0, no feasibility pump";
  }

 protected:
  Result do_solve(const nlp::Problem& problem, std::span<const double> start, const Options& options) const override {
    if (!options.native.empty()) throw std::invalid_argument("Bonmin takes no options here");
    const std::lock_guard lock(*module_function<decltype(accdec_ipopt_mutex)>("ipopt", "accdec_ipopt_mutex")());
    const auto began = std::chrono::steady_clock::now();
    Evaluator evaluator(problem, limits_of(options));
    Result result;
    result.x.assign(start.begin(), start.end());
    const Ipopt::SmartPtr<Adapter> adapter = new Adapter(evaluator, start);
    try {
      Bonmin::BonminSetup setup;
      setup.initializeOptionsAndJournalist();
      setup.readOptionsString(options_text(problem, options));
      setup.initialize(Ipopt::SmartPtr<Bonmin::TMINLP>(Ipopt::GetRawPtr(adapter)));
      Bonmin::Bab search;
      search(setup);
      result.claim = claim_of(search.mipStatus(), seconds_since(began) >= options.time_limit);
      result.message = fmt::format("Bonmin: {} nodes", search.numNodes());
      if (search.bestSolution()) {
        result.x.assign(search.bestSolution(), search.bestSolution() + problem.num_variables());
        result.claimed_objective = search.bestObj();
      }
    } catch (Bonmin::TNLPSolver::UnsolvedError* thrown) {  // it throws pointers
      const std::unique_ptr<Bonmin::TNLPSolver::UnsolvedError> error(thrown);
      result.message = fmt::format("Bonmin: a nonlinear problem was not solved: {}", error->errorName());
    } catch (const Bonmin::OsiTMINLPInterface::SimpleError& error) {
      result.message = "Bonmin: " + error.message();
    } catch (const CoinError& error) {
      result.message = "Bonmin: " + error.message();
    }
    if (!whole(problem)) {
      conclude(evaluator, result);
      return result;
    }
    // The best point seen may have fractions, so it is no answer.
    if (evaluator.stop() == nlp::Stop::exception) std::rethrow_exception(evaluator.exception());
    if (evaluator.stop() == nlp::Stop::time_limit) result.claim = Claim::time_limit;
    result.counts = evaluator.counts();
    return result;
  }

 private:
  static bool whole(const nlp::Problem& problem) {
    for (int i = 0; i < problem.num_variables(); ++i) {
      if (problem.is_integer(i)) return true;
    }
    return false;
  }

  std::string options_text(const nlp::Problem& problem, const Options& options) const {
    std::string text = fmt::format(
        "bonmin.algorithm {}\nbonmin.time_limit {}\ntol {}\nbound_relax_factor 0\nconstr_viol_tol "
        "{}\nbonmin.allowable_gap 5e-4\n"
        "bonmin.allowable_fraction_gap 0\nbonmin.pump_for_minlp no\nbonmin.heuristic_feasibility_pump no\nprint_level "
        "0\nsb yes\n",
        algorithm_, options.time_limit, options.tolerance, 0.1 * options.feasibility_tolerance);
    for (const char* log :
         {"bb_log_level", "lp_log_level", "nlp_log_level", "milp_log_level", "oa_log_level", "fp_log_level"})
      text += fmt::format("bonmin.{} 0\n", log);
    if (!problem.has_hessian()) text += "hessian_approximation limited-memory\n";
    return text;
  }

  std::string name_, algorithm_;
};

}  // namespace
}  // namespace accdec::solvers

void accdec_add_solvers(accdec::solvers::SolverList& list) {
  using namespace accdec::solvers;
  list.push_back(std::make_unique<BonminSolver>("bonmin", "B-BB"));
  list.push_back(std::make_unique<BonminSolver>("bonmin-oa", "B-OA"));
}
