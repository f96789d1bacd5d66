// Ipopt 3.11 with MUMPS: a filter line-search interior-point method.

#include <algorithm>
#include <mutex>
#include <sstream>
#include <stdexcept>

#include <IpoptConfig.h>

#include <IpIpoptApplication.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/solvers/ipopt_problem.hpp>
#include <accdec/solvers/registration.hpp>
#include <accdec/solvers/run.hpp>

namespace accdec::solvers {
namespace {

using nlp::Evaluator;

/// Keeps the answer. Ends the run at the next intermediate callback after a callback reported failure.
class Adapter : public IpoptProblem<Ipopt::TNLP> {
 public:
  Adapter(Evaluator& evaluator, std::span<const double> start)
      : IpoptProblem(evaluator, start), x_(start.begin(), start.end()) {}

  bool finished() const { return finished_; }
  std::vector<double>& x() { return x_; }
  std::vector<double>& multipliers() { return multipliers_; }
  double objective() const { return objective_; }

  // Ipopt 3.11 knows only CPU time limits; wall clock and cancellation are polled here.
  bool intermediate_callback(Ipopt::AlgorithmMode, Ipopt::Index, double, double, double, double, double, double, double,
                             double, Ipopt::Index, const Ipopt::IpoptData*,
                             Ipopt::IpoptCalculatedQuantities*) override {
    return guarded([&] { evaluator().poll(); });
  }

  void finalize_solution(Ipopt::SolverReturn, Ipopt::Index n, const double* x, const double*, const double*,
                         Ipopt::Index m, const double*, const double* multipliers, double objective,
                         const Ipopt::IpoptData*, Ipopt::IpoptCalculatedQuantities*) override {
    finished_ = true;
    x_.assign(x, x + n);
    multipliers_.assign(multipliers, multipliers + m);
    objective_ = objective;
  }

 private:
  std::vector<double> x_, multipliers_;
  double objective_ = 0.0;
  bool finished_ = false;
};

/// Names of options that share a word with `name`, or all names if there are none. Ipopt has about 300.
std::vector<std::string> names_like(Ipopt::IpoptApplication& app, const std::string& name) {
  std::vector<std::string> all, like;
  for (const auto& [known, option] : app.RegOptions()->RegisteredOptionsList()) {
    all.push_back(known);
    std::istringstream words(name);
    bool shares = false;
    for (std::string word; std::getline(words, word, '_');)
      shares = shares || (word.size() > 2 && known.find(word) != std::string::npos);
    if (shares) like.push_back(known);
  }
  return like.empty() ? all : like;
}

void set_native(Ipopt::IpoptApplication& app, const std::string& name, const std::string& value) {
  const Ipopt::SmartPtr<const Ipopt::RegisteredOption> option = app.RegOptions()->GetOption(name);
  if (!Ipopt::IsValid(option)) {
    throw std::invalid_argument(
        fmt::format("Ipopt has no option \"{}\"; known are {}", name, fmt::join(names_like(app, name), ", ")));
  }
  bool ok = false;
  try {
    switch (option->Type()) {
      case Ipopt::OT_Number: ok = app.Options()->SetNumericValue(name, std::stod(value)); break;
      case Ipopt::OT_Integer: ok = app.Options()->SetIntegerValue(name, std::stoi(value)); break;
      default: ok = app.Options()->SetStringValue(name, value); break;
    }
  } catch (const std::logic_error&) {
    ok = false;
  }
  if (!ok) throw std::invalid_argument(fmt::format("Ipopt option \"{}\" does not accept \"{}\"", name, value));
}

Claim claim_of(Ipopt::ApplicationReturnStatus status) {
  switch (status) {
    case Ipopt::Solve_Succeeded: return Claim::solved;
    case Ipopt::Solved_To_Acceptable_Level: return Claim::acceptable;
    case Ipopt::Feasible_Point_Found: return Claim::solved;
    case Ipopt::Infeasible_Problem_Detected: return Claim::infeasible;
    case Ipopt::Diverging_Iterates: return Claim::unbounded;
    case Ipopt::Maximum_Iterations_Exceeded: return Claim::evaluation_limit;
    case Ipopt::Maximum_CpuTime_Exceeded: return Claim::time_limit;
    case Ipopt::User_Requested_Stop: return Claim::cancelled;
    case Ipopt::Invalid_Number_Detected: return Claim::invalid_number;
    default: return Claim::failed;
  }
}

std::string words_of(Ipopt::ApplicationReturnStatus status) {
  switch (status) {
    case Ipopt::Solve_Succeeded: return "";
    case Ipopt::Solved_To_Acceptable_Level: return "Ipopt: solved to acceptable level";
    case Ipopt::Infeasible_Problem_Detected: return "Ipopt: converged to a point of local infeasibility";
    case Ipopt::Search_Direction_Becomes_Too_Small: return "Ipopt: search direction becomes too small";
    case Ipopt::Diverging_Iterates: return "Ipopt: iterates diverge";
    case Ipopt::Maximum_Iterations_Exceeded: return "Ipopt: iteration limit";
    case Ipopt::Restoration_Failed: return "Ipopt: restoration failed";
    case Ipopt::Not_Enough_Degrees_Of_Freedom: return "Ipopt: not enough degrees of freedom";
    case Ipopt::Invalid_Problem_Definition: return "Ipopt: invalid problem definition";
    default: return fmt::format("Ipopt: return status {}", static_cast<int>(status));
  }
}

/// Settings that differ from Ipopt's defaults.
constexpr std::pair<const char*, const char*> own_settings[] = {
    {"bound_relax_factor", "0"},
    // The rows of the formulations are scaled to a bound of 1. Only second differences make their entries very
    // different in size. The default would divide these by 1e6 and more, which is below the precision of the
    // arithmetic. Measured at N = 4000: 3 s instead of 12 s.
    {"nlp_scaling_max_gradient", "1e8"},
    // Measured at N = 1000: 40 iterations to the optimum; the monotone barrier takes 184 to an acceptable point.
    {"mu_strategy", "adaptive"},
    // A search over orders and delays asks about many infeasible points; these heuristics end such runs early.
    {"expect_infeasible_problem", "yes"},
    // Approximate minimum degree that finds dense rows and puts them last: here the position sums. At N = 4000 the
    // automatic choice fills the factors in (180 instead of 30 ms). With 200 corners plain minimum degree (0) does so
    // once it must exchange pivots: one factorisation, which no time limit stops, took 2.5 s instead of 0.15 s.
    {"mumps_pivot_order", "6"},
};

class IpoptSolver final : public Solver {
 public:
  explicit IpoptSolver(bool exact_hessian) : exact_(exact_hessian) {}
  std::string name() const override { return exact_ ? "ipopt" : "ipopt-lbfgs"; }
  std::string library_version() const override { return "Ipopt " IPOPT_VERSION; }
  Capabilities capabilities() const override {
    Capabilities can;
    can.uses_hessian = exact_;
    return can;
  }
  std::string settings() const override {
    std::string all = "tol = tolerance, constr_viol_tol = feasibility_tolerance / 10";
    for (const auto& [key, value] : own_settings) all += fmt::format(", {} = {}", key, value);
    return exact_ ? all : all + ", hessian_approximation = limited-memory";
  }

 protected:
  Result do_solve(const nlp::Problem& problem, std::span<const double> start, const Options& options) const override {
    const std::lock_guard lock(*accdec_ipopt_mutex());
    Evaluator evaluator(problem, limits_of(options));
    const Ipopt::SmartPtr<Adapter> adapter = new Adapter(evaluator, start);
    const Ipopt::SmartPtr<Ipopt::IpoptApplication> app = new Ipopt::IpoptApplication(false);
    app->Options()->SetIntegerValue("print_level", 0);
    app->Options()->SetStringValue("sb", "yes");
    app->Options()->SetNumericValue("tol", options.tolerance);
    // A tenth of the tolerance, as for every library, because the verifier recomputes the rows.
    app->Options()->SetNumericValue("constr_viol_tol", 0.1 * options.feasibility_tolerance);
    app->Options()->SetIntegerValue("max_iter", options.own_budget ? 3000 : 1'000'000'000);
    for (const auto& [key, value] : own_settings) set_native(*app, key, value);
    if (!exact_ || !problem.has_hessian()) app->Options()->SetStringValue("hessian_approximation", "limited-memory");
    for (const auto& [key, value] : options.native) set_native(*app, key, value);

    Result result;
    // An empty name, so that no stray ipopt.opt in the working directory is read.
    Ipopt::ApplicationReturnStatus status = app->Initialize("");
    if (status == Ipopt::Solve_Succeeded)
      status = app->OptimizeTNLP(Ipopt::SmartPtr<Ipopt::TNLP>(Ipopt::GetRawPtr(adapter)));
    result.x = adapter->x();
    // Multipliers of a stopped run do not belong to the returned point.
    if (adapter->finished()) result.row_multipliers = adapter->multipliers();
    result.claimed_objective = adapter->objective();
    result.claim = claim_of(status);
    result.message = words_of(status);
    conclude(evaluator, result);
    return result;
  }

 private:
  bool exact_;
};

}  // namespace
}  // namespace accdec::solvers

std::mutex* accdec_ipopt_mutex() {
  static std::mutex mutex;
  return &mutex;
}

void accdec_add_solvers(accdec::solvers::SolverList& list) {
  using namespace accdec::solvers;
  list.push_back(std::make_unique<IpoptSolver>(true));
  list.push_back(std::make_unique<IpoptSolver>(false));
}
