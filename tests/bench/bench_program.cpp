// Speed of whole programs at N = 40, T = 1 ms, one core.
//   bench_program --benchmark_repetitions=5 --benchmark_report_aggregates_only=true
// Read: bytes_per_second and items (blocks) per second from memory. Delays: corners per second. Verify: samples of the
// program per second, with every joint judged and every limit watched. Program: from text to verified plan, blocks per
// second, for the growth with length. Fixed and profiles: the same for a million blocks with chosen feeds, in plan
// `fixed` for a given filter and in the whole plan `profiles`.

#include <map>
#include <sstream>
#include <string>

#include <benchmark/benchmark.h>

#include <accdec/filter.hpp>
#include <accdec/gcode/generate.hpp>
#include <accdec/gcode/move_sink.hpp>
#include <accdec/plan/command/choose_feeds.hpp>
#include <accdec/plan/command/program_plan.hpp>
#include <accdec/plan/trajectory/plan_profiles.hpp>

namespace {

using namespace accdec;

constexpr double period = 1e-3;

Machine machine() {
  Machine m;
  for (const char* name : {"x", "y", "z"}) {
    Axis axis;
    axis.name = name;
    axis.velocity_max = 1.0;
    axis.acceleration_max = 10.0;
    axis.jerk_max = 1000.0;
    m.axes.push_back(axis);
  }
  return m;
}

const std::string& text_of(GeneratedProgram kind, long blocks) {
  static std::map<std::pair<int, long>, std::string> cache;
  std::string& text = cache[{static_cast<int>(kind), blocks}];
  if (text.empty()) {
    std::ostringstream out;
    GenerateOptions options;
    options.blocks = blocks;
    generate_program(kind, options, out);
    text = std::move(out).str();
  }
  return text;
}

struct Count : MoveSink {
  long moves = 0;
  void begin(const ProgramPoint&) override {}
  void move(const Move&) override { ++moves; }
  void stop(double) override {}
};

GeneratedProgram kind_of(const benchmark::State& state) {
  return static_cast<GeneratedProgram>(state.range(0));
}

void read(benchmark::State& state) {
  const std::string& text = text_of(kind_of(state), state.range(1));
  Count count;
  for (auto _ : state) {
    LineSource source("bench.ngc", text);
    read_program(source, {}, count);
  }
  state.SetItemsProcessed(count.moves);
  state.SetBytesProcessed(static_cast<std::int64_t>(text.size()) * state.iterations());
  state.SetLabel(std::string(to_string(kind_of(state))));
}

void delays(benchmark::State& state) {
  LineSource source("bench.ngc", text_of(kind_of(state), state.range(1)));
  Toolpath path = read_toolpath(source, machine(), {});
  const Filter filter = blackman_sinc(40, 0.049);
  for (auto _ : state) benchmark::DoNotOptimize(pairwise_delays(path, filter, period));
  state.SetItemsProcessed(static_cast<std::int64_t>(path.blocks() - 1) * state.iterations());
  state.SetLabel(std::string(to_string(kind_of(state))));
}

void verify(benchmark::State& state) {
  LineSource source("bench.ngc", text_of(kind_of(state), state.range(1)));
  Toolpath path = read_toolpath(source, machine(), {});
  const Machine m = program_machine(machine(), path);
  const Filter filter = blackman_sinc(40, 0.049);
  const std::vector<int> d = plan_program(path, filter, period, m).delays;
  std::int64_t samples = 0;
  for (auto _ : state) samples += check_program(path, filter, period, m, d).simulation.samples;
  state.SetItemsProcessed(samples);
  state.counters["samples_a_block"] =
      static_cast<double>(samples) / static_cast<double>(state.iterations()) / static_cast<double>(path.blocks());
  state.SetLabel(std::string(to_string(kind_of(state))));
}

void program(benchmark::State& state) {
  const std::string& text = text_of(kind_of(state), state.range(1));
  const Filter filter = blackman_sinc(40, 0.049);
  std::int64_t blocks = 0;
  for (auto _ : state) {
    LineSource source("bench.ngc", text);
    Toolpath path = read_toolpath(source, machine(), {});
    const ProgramPlan plan = plan_program(path, filter, period, program_machine(machine(), path));
    if (!plan.errors_hold) state.SkipWithError("a joint breaks its tolerance");
    blocks += static_cast<std::int64_t>(path.blocks());
  }
  state.SetItemsProcessed(blocks);
  state.SetLabel(std::string(to_string(kind_of(state))));
}

/// Feeds chosen for a boxcar of 20 taps through another of 10, as plan `fixed` does once it has its filter.
void fixed(benchmark::State& state) {
  const std::string& text = text_of(kind_of(state), state.range(1));
  const Filter filter = trapezoid(28, 9);
  std::int64_t blocks = 0;
  for (auto _ : state) {
    LineSource source("bench.ngc", text);
    const Toolpath path = read_toolpath(source, machine(), {});
    const ScheduledPlan plan = schedule_feeds(path, filter, period, program_machine(machine(), path));
    if (!all_holds(plan.plan)) state.SkipWithError("the plan does not hold");
    blocks += static_cast<std::int64_t>(path.blocks());
  }
  state.SetItemsProcessed(blocks);
  state.SetLabel(std::string(to_string(kind_of(state))));
}

void profiles(benchmark::State& state) {
  const std::string& text = text_of(kind_of(state), state.range(1));
  std::int64_t blocks = 0;
  for (auto _ : state) {
    LineSource source("bench.ngc", text);
    const Toolpath path = read_toolpath(source, machine(), {});
    const ProfilePlan plan = plan_profiles(path, program_machine(machine(), path), period);
    if (!plan.holds()) state.SkipWithError("the plan does not hold");
    blocks += static_cast<std::int64_t>(path.blocks());
  }
  state.SetItemsProcessed(blocks);
  state.SetLabel(std::string(to_string(kind_of(state))));
}

void all_kinds(benchmark::internal::Benchmark* b) {
  for (int kind = 0; kind < 6; ++kind) b->Args({kind, 100000});
}
void growth(benchmark::internal::Benchmark* b) {
  for (const GeneratedProgram kind : {GeneratedProgram::zigzag, GeneratedProgram::raster}) {
    for (const long blocks : {1000L, 10000L, 100000L, 1000000L}) b->Args({static_cast<long>(kind), blocks});
  }
}
BENCHMARK(read)->Apply(all_kinds)->Unit(benchmark::kMillisecond);
BENCHMARK(delays)
    ->Apply(all_kinds)
    ->Args({static_cast<long>(GeneratedProgram::zigzag), 1000000})
    ->Unit(benchmark::kMillisecond);
BENCHMARK(verify)->Apply(all_kinds)->Unit(benchmark::kMillisecond);
BENCHMARK(program)->Apply(growth)->Unit(benchmark::kMillisecond);
BENCHMARK(fixed)->Args({static_cast<long>(GeneratedProgram::raster), 1000000})->Unit(benchmark::kMillisecond);
BENCHMARK(profiles)->Args({static_cast<long>(GeneratedProgram::raster), 1000000})->Unit(benchmark::kMillisecond);

}  // namespace
