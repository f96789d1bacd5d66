// Smallest delay for random corners: angle 1 .. 180 deg, both feeds 6 .. 60 m/min and tolerance 5 .. 200 um all
// different. items_per_second is corners per second on one core; the argument is the filter's order N.
//   bench_delay --benchmark_repetitions=5 --benchmark_report_aggregates_only=true
//
// Its limits, measured on one core at 2.6 GHz: 78 ns a corner at N = 40 (13 million a second), 140 ns at N = 4000.
// A corner takes 3.3 values of d(k) at N = 40 and 4.9 at N = 4000; three is the least that proves a minimum. It takes
// 1.8 distances to find the whole delay. No part dominates. Computing the square root of the cosine law twice costs 7
// ns more, that of the look-up 7 ns, and the dependent load of its table 8 ns. Corners in an order that the branch
// predictor knows save 3 ns. The rest is the latency of one chain of about 100 additions and products. So only several
// corners side by side (SIMD) would be much faster. At N = 4000 the tables (320 kB) come from the second-level cache.

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include <benchmark/benchmark.h>

#include <accdec/corner.hpp>
#include <accdec/filter.hpp>

namespace {

using accdec::DelayFinder;
using accdec::Filter;

struct Case {
  double cos_interior, step_in, step_out, error_max;
};

/// @param sample_period  s
std::vector<Case> random_corners(double angle_low_deg, double angle_high_deg, double sample_period) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> angle(angle_low_deg, angle_high_deg), feed(0.1, 1.0),
      tolerance(std::log(5e-6), std::log(200e-6));
  std::vector<Case> corners(1 << 16);
  for (Case& c : corners) {
    const double theta = angle(random) * std::numbers::pi / 180.0;
    c = {std::cos(theta), feed(random) * sample_period, feed(random) * sample_period, std::exp(tolerance(random))};
  }
  return corners;
}

void run(benchmark::State& state, const Filter& filter, double low, double high, double sample_period) {
  const DelayFinder finder(filter);
  const std::vector<Case> corners = random_corners(low, high, sample_period);
  std::size_t i = 0;
  double delays = 0.0;
  for (auto _ : state) {
    const Case& c = corners[i++ & (corners.size() - 1)];
    const int d = finder(c.cos_interior, c.step_in, c.step_out, c.error_max);
    benchmark::DoNotOptimize(d);
    delays += d;
  }
  state.SetItemsProcessed(state.iterations());
  state.counters["mean_delay"] = delays / static_cast<double>(state.iterations());
}

// The Acc/Dec time stays 40 ms while the sampling gets finer: the same motion, resolved by more samples.
double period(const benchmark::State& state) {
  return 0.04 / static_cast<double>(state.range(0));
}

void blackman_sinc(benchmark::State& state) {
  const int order = static_cast<int>(state.range(0));
  run(state, accdec::blackman_sinc(order, 1.96 / order), 1.0, 180.0, period(state));
}
void boxcar(benchmark::State& state) {
  run(state, accdec::boxcar(static_cast<int>(state.range(0))), 1.0, 180.0, period(state));
}
// The same at a fixed sample period of 1 ms: the filter gets longer, a sample's step stays far above the tolerance.
void blackman_sinc_1ms(benchmark::State& state) {
  const int order = static_cast<int>(state.range(0));
  run(state, accdec::blackman_sinc(order, 1.96 / order), 1.0, 180.0, 1e-3);
}
void sharp(benchmark::State& state) {
  const int order = static_cast<int>(state.range(0));
  run(state, accdec::blackman_sinc(order, 1.96 / order), 1.0, 90.0, period(state));
}
void flat(benchmark::State& state) {
  const int order = static_cast<int>(state.range(0));
  run(state, accdec::blackman_sinc(order, 1.96 / order), 90.0, 180.0, period(state));
}
// The stated worst case: almost straight, the tolerance a thousandth of a sample's step.
void nearly_straight_1ms(benchmark::State& state) {
  const int order = static_cast<int>(state.range(0));
  run(state, accdec::blackman_sinc(order, 1.96 / order), 179.9, 180.0, 1e-3);
}

void orders(benchmark::internal::Benchmark* b) {
  for (int order : {10, 40, 100, 400, 1000, 4000}) b->Arg(order);
}
BENCHMARK(blackman_sinc)->Apply(orders);
BENCHMARK(boxcar)->Apply(orders);
BENCHMARK(blackman_sinc_1ms)->Apply(orders);
BENCHMARK(sharp)->Apply(orders);
BENCHMARK(flat)->Apply(orders);
BENCHMARK(nearly_straight_1ms)->Apply(orders);

}  // namespace
