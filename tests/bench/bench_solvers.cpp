// How the delay formulation scales with the order N, and how long Ipopt takes on it. The largest order runs once: about
// a minute.
//   bench_solvers --benchmark_repetitions=5 --benchmark_report_aggregates_only=true      (read the medians)

#include <numbers>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include <accdec/design/formulation.hpp>
#include <accdec/filter.hpp>
#include <accdec/solver.hpp>

namespace {

using namespace accdec;

/// One 95 degree corner at 6 m/min whose limits bind alike at every order: the sample period shrinks, the Acc/Dec time
/// stays 40 ms.
Task task_of(int order) {
  Task task;
  task.sample_period = 0.04 / order;
  Axis axis;
  axis.acceleration_max = 6.0;
  axis.jerk_max = 600.0;
  for (const char* name : {"x", "y"}) task.machine.axes.push_back(axis), task.machine.axes.back().name = name;
  TaskCorner corner("A", PlanarLegs{95.0 * std::numbers::pi / 180.0, 0.0, Turn::left}, 0.1, 0.1);
  corner.error_max = 50e-6;
  task.corners.push_back(corner);
  return task;
}

DelayProblem problem_of(const Task& task, int order) {
  FormulationOptions options;
  options.order = order;
  options.blend_delays = {order / 4};
  return DelayProblem(task, options);
}

std::vector<double> start_of(const DelayProblem& problem, int order) {
  return problem.start_from(trapezoid(order, order / 3), std::vector<double>{order / 4.0});
}

void rows_and_jacobian(benchmark::State& state) {
  const int order = static_cast<int>(state.range(0));
  const DelayProblem problem = problem_of(task_of(order), order);
  const std::vector<double> x = start_of(problem, order);
  std::vector<double> c(static_cast<std::size_t>(problem.num_rows())), values(problem.jacobian_pattern().size());
  for (auto _ : state) {
    problem.rows(x, c);
    problem.jacobian(x, values);
    benchmark::DoNotOptimize(c.data());
    benchmark::DoNotOptimize(values.data());
  }
  state.SetComplexityN(order);
  state.counters["nonzeros"] = static_cast<double>(values.size());
}
BENCHMARK(rows_and_jacobian)->Arg(50)->Arg(200)->Arg(1000)->Arg(5000)->Arg(20000)->Complexity(benchmark::oN);

void ipopt(benchmark::State& state) {
  const int order = static_cast<int>(state.range(0));
  const DelayProblem problem = problem_of(task_of(order), order);
  const std::vector<double> x = start_of(problem, order);
  const solvers::Solver& solver = solvers::find_solver("ipopt");
  solvers::Options options;
  options.time_limit = 600.0;
  solvers::Result result;
  for (auto _ : state) result = solver.solve(problem, x, options);
  state.SetLabel(std::string(to_string(result.claim)) + ", " + std::string(to_string(result.verification.verdict)));
  state.counters["evaluations"] = static_cast<double>(result.counts.objective);
  state.counters["delay/N"] = problem.delays(result.x)[0] / order;
}
BENCHMARK(ipopt)->Arg(40)->Arg(1000)->Unit(benchmark::kMillisecond);
BENCHMARK(ipopt)->Arg(10000)->Unit(benchmark::kMillisecond)->Iterations(1)->Repetitions(1);

}  // namespace
