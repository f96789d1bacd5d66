// Two habits of Ipopt 3.11.9 called as it is, and what its adapter makes of them.

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include <unistd.h>

#include <IpIpoptApplication.hpp>
#include <IpTNLP.hpp>
#include <conformance/cases.hpp>
#include <gtest/gtest.h>

#include <accdec/solver.hpp>

namespace accdec::testing {
namespace {

using Ipopt::Index;
using solvers::Claim;
using solvers::find_solver;
using solvers::Result;
using solvers::Verdict;

/// The problem handed over as it is.
class Raw : public Ipopt::TNLP {
 public:
  Raw(const nlp::Problem& problem, std::vector<double> start) : problem_(problem), x(std::move(start)) {}

  bool get_nlp_info(Index& n, Index& m, Index& jacobian, Index& hessian, IndexStyleEnum& style) override {
    n = problem_.num_variables();
    m = problem_.num_rows();
    jacobian = static_cast<Index>(problem_.jacobian_pattern().size());
    hessian = static_cast<Index>(problem_.hessian_pattern().size());
    style = C_STYLE;
    return true;
  }
  bool get_bounds_info(Index n, double* xl, double* xu, Index m, double* cl, double* cu) override {
    const auto fill = [](nlp::Bound b, double& lower, double& upper) {
      lower = std::max(b.lower, -2e19);
      upper = std::min(b.upper, 2e19);
    };
    for (int i = 0; i < n; ++i) fill(problem_.variable_bound(i), xl[i], xu[i]);
    for (int i = 0; i < m; ++i) fill(problem_.row_bound(i), cl[i], cu[i]);
    return true;
  }
  bool get_starting_point(Index, bool, double* out, bool, double*, double*, Index, bool, double*) override {
    std::copy(x.begin(), x.end(), out);
    return true;
  }
  bool eval_f(Index n, const double* at, bool, double& value) override {
    value = problem_.objective({at, size(n)});
    return true;
  }
  bool eval_grad_f(Index n, const double* at, bool, double* g) override {
    problem_.gradient({at, size(n)}, {g, size(n)});
    return true;
  }
  bool eval_g(Index n, const double* at, bool, Index m, double* c) override {
    problem_.rows({at, size(n)}, {c, size(m)});
    return true;
  }
  bool eval_jac_g(Index n, const double* at, bool, Index, Index count, Index* rows, Index* columns,
                  double* values) override {
    if (values == nullptr) return pattern(problem_.jacobian_pattern(), rows, columns);
    problem_.jacobian({at, size(n)}, {values, size(count)});
    return true;
  }
  bool eval_h(Index n, const double* at, bool, double factor, Index m, const double* y, bool, Index count, Index* rows,
              Index* columns, double* values) override {
    if (values == nullptr) return pattern(problem_.hessian_pattern(), rows, columns);
    problem_.hessian({at, size(n)}, factor, {y, size(m)}, {values, size(count)});
    return true;
  }
  void finalize_solution(Ipopt::SolverReturn, Index n, const double* at, const double*, const double*, Index,
                         const double*, const double*, double value, const Ipopt::IpoptData*,
                         Ipopt::IpoptCalculatedQuantities*) override {
    finished = true;
    x.assign(at, at + n);
    objective = value;
  }

 private:
  static std::size_t size(Index i) { return static_cast<std::size_t>(i); }
  static bool pattern(const std::vector<nlp::Entry>& entries, Index* rows, Index* columns) {
    for (const nlp::Entry& e : entries) *rows++ = e.row, *columns++ = e.column;
    return true;
  }
  const nlp::Problem& problem_;

 public:
  std::vector<double> x;
  double objective = 0.0;
  bool finished = false;
};

struct Ended {
  Ipopt::SmartPtr<Raw> raw;
  Ipopt::ApplicationReturnStatus status;
};

Ended solve_raw(const nlp::Problem& problem, const std::vector<double>& start) {
  const Ipopt::SmartPtr<Ipopt::IpoptApplication> app = new Ipopt::IpoptApplication(false);
  app->Options()->SetIntegerValue("print_level", 0);
  app->Options()->SetStringValue("sb", "yes");
  app->Initialize("");
  const Ipopt::SmartPtr<Raw> raw = new Raw(problem, start);
  return {raw, app->OptimizeTNLP(Ipopt::SmartPtr<Ipopt::TNLP>(Ipopt::GetRawPtr(raw)))};
}

const Case& case_named(const std::string& name) {
  for (const Case& c : cases()) {
    if (c.problem.name() == name) return c;
  }
  throw std::logic_error("no case " + name);
}

FormulaProblem overdetermined() {  // three equalities that agree, two variables
  return {"overdetermined",
          {{}, {}},
          [](const Variables& x) { return sqr(x[0]) + sqr(x[1]); },
          {{{1.0, 1.0}, [](const Variables& x) { return x[0] + 0.0 * x[1]; }},
           {{2.0, 2.0}, [](const Variables& x) { return 0.0 * x[0] + x[1]; }},
           {{3.0, 3.0}, [](const Variables& x) { return x[0] + x[1]; }}}};
}

TEST(IpoptLibrary, EndsWithoutAnAnswerOnTooManyEqualitiesAndTheAdapterJudgesThePointItHas) {
  const Ended raw = solve_raw(overdetermined(), {0.0, 0.0});
  EXPECT_EQ(raw.status, Ipopt::Not_Enough_Degrees_Of_Freedom);
  EXPECT_FALSE(raw.raw->finished);
  for (const char* name : {"ipopt", "ipopt-lbfgs"}) {
    const Result result = find_solver(name).solve(overdetermined(), std::vector<double>{0.0, 0.0});
    ASSERT_EQ(result.x.size(), 2u);
    // A point is returned whatever the library did, and it is either the answer or called what it is.
    const bool right = std::abs(result.x[0] - 1.0) < 1e-6 && std::abs(result.x[1] - 2.0) < 1e-6;
    EXPECT_EQ(result.verification.verdict == Verdict::infeasible, !right) << result.message;
    EXPECT_TRUE(right || result.claim == Claim::failed) << to_string(result.claim);
  }
}

TEST(IpoptLibrary, ReadsAStrayOptionFileAndTheAdapterDoesNot) {
  const std::filesystem::path before = std::filesystem::current_path();
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("accdec_ipopt_" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  std::filesystem::current_path(folder);
  std::ofstream("ipopt.opt") << "max_iter 1\n";
  const Case& c = case_named("HS071");

  const Ipopt::SmartPtr<Ipopt::IpoptApplication> app = new Ipopt::IpoptApplication(false);
  app->Options()->SetIntegerValue("print_level", 0);
  app->Options()->SetStringValue("sb", "yes");
  app->Initialize();
  const Ipopt::SmartPtr<Ipopt::TNLP> raw = new Raw(c.problem, c.start);
  EXPECT_EQ(app->OptimizeTNLP(raw), Ipopt::Maximum_Iterations_Exceeded);
  EXPECT_EQ(find_solver("ipopt").solve(c.problem, c.start).claim, Claim::solved);

  std::filesystem::current_path(before);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace accdec::testing
