// Cost of the solver interface: Ipopt is called through it and directly, with the same options, on the same delay
// problem (the argument is the filter's order N). The interface adds counting, timing, checks of finiteness, and the
// verification of the answer.
//   bench_interface --benchmark_repetitions=15 --benchmark_enable_random_interleaving=true
//   --benchmark_report_aggregates_only=true
// Compare the medians of CPU time; `gradients`, calls in one solve, shows that both took the same path.

#include <algorithm>
#include <utility>
#include <vector>

#include <IpIpoptApplication.hpp>
#include <IpTNLP.hpp>
#include <benchmark/benchmark.h>

#include <accdec/design/formulation.hpp>
#include <accdec/filter.hpp>
#include <accdec/solver.hpp>

#include "support/tasks.hpp"

namespace {

using accdec::nlp::Problem;
using Ipopt::Index;

/// The least a program must write to have Ipopt solve a Problem.
class Direct : public Ipopt::TNLP {
 public:
  Direct(const Problem& problem, std::vector<double> start) : problem_(problem), x_(std::move(start)) {}
  double objective = 0.0;
  int gradients = 0;

  bool get_nlp_info(Index& n, Index& m, Index& jacobian, Index& hessian, IndexStyleEnum& style) override {
    n = problem_.num_variables();
    m = problem_.num_rows();
    jacobian = static_cast<Index>(problem_.jacobian_pattern().size());
    hessian = static_cast<Index>(problem_.hessian_pattern().size());
    style = C_STYLE;
    return true;
  }
  bool get_bounds_info(Index n, double* xl, double* xu, Index m, double* cl, double* cu) override {
    const auto fill = [](accdec::nlp::Bound b, double& lower, double& upper) {
      lower = std::max(b.lower, -2e19);
      upper = std::min(b.upper, 2e19);
    };
    for (int i = 0; i < n; ++i) fill(problem_.variable_bound(i), xl[i], xu[i]);
    for (int i = 0; i < m; ++i) fill(problem_.row_bound(i), cl[i], cu[i]);
    return true;
  }
  bool get_starting_point(Index, bool, double* x, bool, double*, double*, Index, bool, double*) override {
    // The interface starts inside the bounds.
    for (std::size_t i = 0; i < x_.size(); ++i) {
      const accdec::nlp::Bound b = problem_.variable_bound(static_cast<int>(i));
      x[i] = std::clamp(x_[i], b.lower, b.upper);
    }
    return true;
  }
  bool eval_f(Index n, const double* x, bool, double& value) override {
    value = problem_.objective({x, size(n)});
    return true;
  }
  bool eval_grad_f(Index n, const double* x, bool, double* g) override {
    ++gradients;
    problem_.gradient({x, size(n)}, {g, size(n)});
    return true;
  }
  bool eval_g(Index n, const double* x, bool, Index m, double* c) override {
    problem_.rows({x, size(n)}, {c, size(m)});
    return true;
  }
  bool eval_jac_g(Index n, const double* x, bool, Index, Index count, Index* rows, Index* columns,
                  double* values) override {
    if (values == nullptr) return pattern(problem_.jacobian_pattern(), rows, columns);
    problem_.jacobian({x, size(n)}, {values, size(count)});
    return true;
  }
  bool eval_h(Index n, const double* x, bool, double factor, Index m, const double* y, bool, Index count, Index* rows,
              Index* columns, double* values) override {
    if (values == nullptr) return pattern(problem_.hessian_pattern(), rows, columns);
    problem_.hessian({x, size(n)}, factor, {y, size(m)}, {values, size(count)});
    return true;
  }
  void finalize_solution(Ipopt::SolverReturn, Index, const double*, const double*, const double*, Index, const double*,
                         const double*, double value, const Ipopt::IpoptData*,
                         Ipopt::IpoptCalculatedQuantities*) override {
    objective = value;
  }

 private:
  static std::size_t size(Index i) { return static_cast<std::size_t>(i); }
  static bool pattern(const std::vector<accdec::nlp::Entry>& entries, Index* rows, Index* columns) {
    for (const accdec::nlp::Entry& e : entries) *rows++ = e.row, *columns++ = e.column;
    return true;
  }
  const Problem& problem_;
  std::vector<double> x_;
};

/// Acceleration, jerk and force limits that a filter of this order can just about use up.
accdec::Task task_for(int order) {
  const double scale = 40.0 / order;
  accdec::Axis axis;
  axis.acceleration_max = 6.0 * scale;
  axis.jerk_max = 600.0 * scale * scale;
  axis.mass = 34.0;
  axis.damping = 60.0;
  axis.force_max = 230.0 * scale;
  return accdec::testing::plane_task(axis, accdec::testing::plane_corner("A", 95, 20, 0.1, 0.1), 40e-6 / scale);
}

struct Posed {
  accdec::Task task;
  accdec::DelayProblem problem;
  std::vector<double> start;

  explicit Posed(int order) : task(task_for(order)), problem(task, options(order)) {
    const std::vector<double> delays{0.4 * order};
    start = problem.start_from(accdec::trapezoid(order, order / 3), delays);
  }
  static accdec::FormulationOptions options(int order) {
    accdec::FormulationOptions o;
    o.order = order;
    o.blend_delays = {2 * order / 5};
    return o;
  }
};

void through_the_interface(benchmark::State& state) {
  const Posed posed(static_cast<int>(state.range(0)));
  const accdec::solvers::Solver& solver = accdec::solvers::find_solver("ipopt");
  accdec::solvers::Result result;
  for (auto _ : state) result = solver.solve(posed.problem, posed.start);
  if (result.verification.verdict != accdec::solvers::Verdict::optimal) state.SkipWithError("not solved");
  state.counters["objective"] = result.verification.objective;
  state.counters["gradients"] = static_cast<double>(result.counts.gradient);
}

void directly(benchmark::State& state) {
  const Posed posed(static_cast<int>(state.range(0)));
  double objective = 0.0, gradients = 0.0;
  for (auto _ : state) {
    const Ipopt::SmartPtr<Ipopt::IpoptApplication> app = new Ipopt::IpoptApplication(false);
    const Ipopt::SmartPtr<Direct> direct = new Direct(posed.problem, posed.start);
    const accdec::solvers::Options options;
    app->Options()->SetIntegerValue("print_level", 0);
    app->Options()->SetStringValue("sb", "yes");
    app->Options()->SetNumericValue("tol", options.tolerance);
    app->Options()->SetNumericValue("constr_viol_tol", options.feasibility_tolerance);
    app->Options()->SetNumericValue("bound_relax_factor", 0.0);
    app->Options()->SetIntegerValue("max_iter", 3000);
    app->Options()->SetNumericValue("nlp_scaling_max_gradient", 1e8);
    app->Options()->SetStringValue("mu_strategy", "adaptive");
    app->Options()->SetStringValue("expect_infeasible_problem", "yes");
    app->Options()->SetIntegerValue("mumps_pivot_order", 6);
    app->Initialize("");
    const auto status = app->OptimizeTNLP(Ipopt::SmartPtr<Ipopt::TNLP>(Ipopt::GetRawPtr(direct)));
    if (status != Ipopt::Solve_Succeeded) state.SkipWithError("not solved");
    objective = direct->objective;
    gradients = direct->gradients;
  }
  state.counters["objective"] = objective;
  state.counters["gradients"] = gradients;
}

BENCHMARK(through_the_interface)->Arg(40)->Unit(benchmark::kMillisecond);
BENCHMARK(directly)->Arg(40)->Unit(benchmark::kMillisecond);

}  // namespace
