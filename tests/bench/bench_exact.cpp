#include <benchmark/benchmark.h>

#include <accdec/certificate.hpp>
#include <accdec/exact/exact.hpp>

#include "support/tasks.hpp"

namespace accdec {
namespace {

/// One corner of 95 degrees under acceleration and jerk limits; the argument is the sample period in us, so the orders
/// grow as it falls.
Task corner_task(double period) {
  Axis axis;
  axis.acceleration_max = 6.0;
  axis.jerk_max = 500.0;
  Task task = testing::plane_task(axis, testing::plane_corner("A", 95, 0, 0.1, 0.1), 50e-6);
  task.sample_period = period;
  task.design.order_max = static_cast<int>(0.4 / period);
  return task;
}

void run(benchmark::State& state, const Task& task) {
  DesignResult result;
  for (auto _ : state) result = design_exact(task);
  state.SetLabel(std::string(to_string(result.status)));
  state.counters["total"] = result.filter ? result.filter->order() + result.corners[0].delay : 0;
  state.counters["linear_programs"] = static_cast<double>(result.solver.evaluations);
}

void BM_LinearLimits(benchmark::State& state) {
  run(state, corner_task(1e-6 * static_cast<double>(state.range(0))));
}
BENCHMARK(BM_LinearLimits)->Arg(2000)->Arg(1000)->Arg(700)->Arg(400)->Arg(200)->Unit(benchmark::kMillisecond);

void BM_VibrationBand(benchmark::State& state) {
  Task task = corner_task(1e-3);
  task.machine.modes.push_back({38.0, 46.0, 0.05});
  run(state, task);
}
BENCHMARK(BM_VibrationBand)->Unit(benchmark::kMillisecond);

void BM_Check(benchmark::State& state) {
  const Task task = corner_task(0.7e-3);
  const DesignResult result = design_exact(task);
  for (auto _ : state) benchmark::DoNotOptimize(check_certificate(task, result).accepted);
}
BENCHMARK(BM_Check)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace accdec
