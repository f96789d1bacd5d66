// Ipopt on its own, called directly, and what comes out of the interface instead.

#include <algorithm>
#include <atomic>
#include <cmath>
#include <thread>
#include <vector>

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <IpIpoptApplication.hpp>
#include <IpTNLP.hpp>
#include <conformance/cases.hpp>
#include <gtest/gtest.h>

#include <accdec/solver.hpp>

namespace accdec::testing {
namespace {

using solvers::Claim;
using solvers::find_solver;
using solvers::Result;

/// Works until the process's user time has moved. It moves in steps of up to 10 ms, by machine: a limit on it means
/// nothing below that.
void spend_user_time() {
  const auto user = [] {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return std::pair(usage.ru_utime.tv_sec, usage.ru_utime.tv_usec);
  };
  const auto start = user();
  while (user() == start) {
  }
}

/// minimise (x - 3)^2 over lower <= x <= upper, straight to Ipopt.
class Raw : public Ipopt::TNLP {
 public:
  Raw(double lower, double upper) : lower_(lower), upper_(upper) {}
  bool throws = false, finished = false, slow = false;
  double x = -1.0, objective = -1.0, largest = -1.0;
  bool get_nlp_info(Ipopt::Index& n, Ipopt::Index& m, Ipopt::Index& jacobian, Ipopt::Index& hessian,
                    IndexStyleEnum& style) override {
    n = hessian = 1, m = jacobian = 0, style = C_STYLE;
    return true;
  }
  bool get_bounds_info(Ipopt::Index, double* xl, double* xu, Ipopt::Index, double*, double*) override {
    xl[0] = lower_, xu[0] = upper_;
    return true;
  }
  bool get_starting_point(Ipopt::Index, bool, double* s, bool, double*, double*, Ipopt::Index, bool, double*) override {
    s[0] = 1.0;
    if (slow) spend_user_time();
    return true;
  }
  bool eval_f(Ipopt::Index, const double* p, bool, double& value) override {
    if (throws) throw std::domain_error("mine");
    largest = std::max(largest, p[0]);
    value = (p[0] - 3.0) * (p[0] - 3.0);
    return true;
  }
  bool eval_grad_f(Ipopt::Index, const double* p, bool, double* g) override {
    g[0] = 2.0 * (p[0] - 3.0);
    return true;
  }
  bool eval_g(Ipopt::Index, const double*, bool, Ipopt::Index, double*) override { return true; }
  bool eval_jac_g(Ipopt::Index, const double*, bool, Ipopt::Index, Ipopt::Index, Ipopt::Index*, Ipopt::Index*,
                  double*) override {
    return true;
  }
  bool eval_h(Ipopt::Index, const double*, bool, double factor, Ipopt::Index, const double*, bool, Ipopt::Index,
              Ipopt::Index* rows, Ipopt::Index* columns, double* values) override {
    if (values == nullptr) {
      rows[0] = columns[0] = 0;
    } else {
      values[0] = 2.0 * factor;
    }
    return true;
  }
  void finalize_solution(Ipopt::SolverReturn, Ipopt::Index, const double* p, const double*, const double*, Ipopt::Index,
                         const double*, const double*, double value, const Ipopt::IpoptData*,
                         Ipopt::IpoptCalculatedQuantities*) override {
    finished = true, x = p[0], objective = value;
  }

 private:
  double lower_, upper_;
};

FormulaProblem parabola(double lower, double upper) {
  return {"parabola", {{lower, upper}}, [](const Variables& x) { return sqr(x[0] - 3.0); }, {}};
}

Ipopt::SmartPtr<Ipopt::IpoptApplication> application() {
  Ipopt::SmartPtr<Ipopt::IpoptApplication> app = new Ipopt::IpoptApplication(false);
  app->Options()->SetIntegerValue("print_level", 0);
  app->Options()->SetStringValue("sb", "yes");
  app->Initialize("");
  return app;
}

TEST(IpoptMisbehaviour, LeavesBoundsAndTheInterfaceDoesNot) {
  const Ipopt::SmartPtr<Raw> raw = new Raw(0.0, 2.0);
  application()->OptimizeTNLP(Ipopt::SmartPtr<Ipopt::TNLP>(Ipopt::GetRawPtr(raw)));
  EXPECT_GT(raw->largest, 2.0 + 1e-9);  // it evaluates outside the bounds, where a function may not exist
  class Recording : public FormulaProblem {
   public:
    Recording() : FormulaProblem(parabola(0.0, 2.0)) {}
    double objective(std::span<const double> x) const override {
      largest = std::max(largest, x[0]);
      return FormulaProblem::objective(x);
    }
    mutable double largest = -1.0;
  };
  const Recording problem;
  const Result result = find_solver("ipopt").solve(problem, std::vector<double>{1.0});
  EXPECT_LE(problem.largest, 2.0);
  EXPECT_LE(result.x[0], 2.0);
  EXPECT_EQ(result.verification.bound_violation, 0.0);
}

TEST(IpoptMisbehaviour, CrossedBoundsEndWithoutASolution) {
  const Ipopt::SmartPtr<Raw> raw = new Raw(2.0, 1.0);
  const auto status = application()->OptimizeTNLP(Ipopt::SmartPtr<Ipopt::TNLP>(Ipopt::GetRawPtr(raw)));
  EXPECT_NE(status, Ipopt::Solve_Succeeded);
  EXPECT_FALSE(raw->finished);
  EXPECT_EQ(find_solver("ipopt").solve(parabola(2.0, 1.0), std::vector<double>{1.0}).claim, Claim::refused);
}

TEST(IpoptMisbehaviour, LosesExceptions) {
  const Ipopt::SmartPtr<Raw> raw = new Raw(0.0, 5.0);
  raw->throws = true;
  Ipopt::ApplicationReturnStatus status = Ipopt::Solve_Succeeded;
  EXPECT_NO_THROW(status = application()->OptimizeTNLP(Ipopt::SmartPtr<Ipopt::TNLP>(Ipopt::GetRawPtr(raw))));
  EXPECT_EQ(status, Ipopt::NonIpopt_Exception_Thrown);
  class Throwing : public FormulaProblem {
   public:
    Throwing() : FormulaProblem(parabola(0.0, 5.0)) {}
    double objective(std::span<const double>) const override { throw std::domain_error("mine"); }
  };
  EXPECT_THROW(find_solver("ipopt").solve(Throwing(), std::vector<double>{1.0}), std::domain_error);
}

TEST(IpoptMisbehaviour, ReportsAnObjectiveThatIsNotItsPoints) {
  const Ipopt::SmartPtr<Raw> raw = new Raw(0.0, 5.0);
  raw->slow = true;
  const auto app = application();
  EXPECT_FALSE(app->Options()->SetNumericValue("max_wall_time", 1.0)) << "3.11 has CPU time limits only";
  app->Options()->SetNumericValue("max_cpu_time", 1e-12);
  EXPECT_EQ(app->OptimizeTNLP(Ipopt::SmartPtr<Ipopt::TNLP>(Ipopt::GetRawPtr(raw))), Ipopt::Maximum_CpuTime_Exceeded);
  EXPECT_GT(std::abs(raw->objective - (raw->x - 3.0) * (raw->x - 3.0)), 1.0);
  solvers::Options options;
  options.native["max_cpu_time"] = "1e-12";
  const auto slow = [](const Variables& x) {
    spend_user_time();
    return sqr(x[0] - 3.0);
  };
  const FormulaProblem problem("slow parabola", {{0.0, 5.0}}, slow, {});
  const Result result = find_solver("ipopt").solve(problem, std::vector<double>{1.0}, options);
  EXPECT_EQ(result.claim, Claim::time_limit);
  EXPECT_DOUBLE_EQ(result.verification.objective, problem.objective(result.x));
}

/// minimise sum (x_i - 2)^2 subject to x_i + x_{i+1}^2 = 2: enough for MUMPS to factorise something.
class Chain : public Ipopt::TNLP {
 public:
  bool get_nlp_info(Ipopt::Index& n, Ipopt::Index& m, Ipopt::Index& jacobian, Ipopt::Index& hessian,
                    IndexStyleEnum& style) override {
    n = hessian = size, m = size - 1, jacobian = 2 * m, style = C_STYLE;
    return true;
  }
  bool get_bounds_info(Ipopt::Index n, double* xl, double* xu, Ipopt::Index m, double* cl, double* cu) override {
    std::fill_n(xl, n, -10.0), std::fill_n(xu, n, 10.0), std::fill_n(cl, m, 2.0), std::fill_n(cu, m, 2.0);
    return true;
  }
  bool get_starting_point(Ipopt::Index n, bool, double* x, bool, double*, double*, Ipopt::Index, bool,
                          double*) override {
    std::fill_n(x, n, 0.5);
    return true;
  }
  bool eval_f(Ipopt::Index n, const double* x, bool, double& f) override {
    f = 0.0;
    for (int i = 0; i < n; ++i) f += (x[i] - 2.0) * (x[i] - 2.0);
    return true;
  }
  bool eval_grad_f(Ipopt::Index n, const double* x, bool, double* g) override {
    for (int i = 0; i < n; ++i) g[i] = 2.0 * (x[i] - 2.0);
    return true;
  }
  bool eval_g(Ipopt::Index, const double* x, bool, Ipopt::Index m, double* g) override {
    for (int i = 0; i < m; ++i) g[i] = x[i] + x[i + 1] * x[i + 1];
    return true;
  }
  bool eval_jac_g(Ipopt::Index, const double* x, bool, Ipopt::Index m, Ipopt::Index, Ipopt::Index* rows,
                  Ipopt::Index* columns, double* values) override {
    for (int i = 0; i < m; ++i) {
      if (values == nullptr) {
        rows[2 * i] = rows[2 * i + 1] = i, columns[2 * i] = i, columns[2 * i + 1] = i + 1;
      } else {
        values[2 * i] = 1.0, values[2 * i + 1] = 2.0 * x[i + 1];
      }
    }
    return true;
  }
  bool eval_h(Ipopt::Index n, const double*, bool, double factor, Ipopt::Index, const double* y, bool, Ipopt::Index,
              Ipopt::Index* rows, Ipopt::Index* columns, double* values) override {
    for (int i = 0; i < n; ++i) {
      if (values == nullptr) {
        rows[i] = columns[i] = i;
      } else {
        values[i] = 2.0 * factor + (i > 0 ? 2.0 * y[i - 1] : 0.0);
      }
    }
    return true;
  }
  void finalize_solution(Ipopt::SolverReturn, Ipopt::Index, const double*, const double*, const double*, Ipopt::Index,
                         const double*, const double*, double, const Ipopt::IpoptData*,
                         Ipopt::IpoptCalculatedQuantities*) override {}

 private:
  static constexpr int size = 50;
};

// That the interface gives right answers from eight threads is asserted for every algorithm in
// Threads.EveryAlgorithmAtOnce...
TEST(IpoptMisbehaviour, EightThreadsCrash) {
  constexpr int sound = 42;
  int broken = 0;
  // Each child breaks with a probability near one; ten sound ones in a row would mean that the lock is no longer
  // needed.
  for (int attempt = 0; attempt < 10 && broken == 0; ++attempt) {
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      close(STDOUT_FILENO), close(STDERR_FILENO);  // the crash talks
      alarm(20);
      std::atomic<bool> solved = true;
      std::vector<std::thread> threads;
      for (int i = 0; i < 8; ++i) {
        threads.emplace_back([&] {
          for (int k = 0; k < 20; ++k) {
            const auto status = application()->OptimizeTNLP(Ipopt::SmartPtr<Ipopt::TNLP>(new Chain));
            if (status != Ipopt::Solve_Succeeded) solved = false;
          }
        });
      }
      for (std::thread& thread : threads) thread.join();
      _exit(solved ? sound : 1);
    }
    int status = 0;
    waitpid(child, &status, 0);
    if (!(WIFEXITED(status) && WEXITSTATUS(status) == sound)) ++broken;
  }
  EXPECT_GT(broken, 0);
}

}  // namespace
}  // namespace accdec::testing
