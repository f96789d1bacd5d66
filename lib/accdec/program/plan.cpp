#include <accdec/program/plan.hpp>

#include <algorithm>
#include <cmath>

#include <accdec/design/verifier.hpp>
#include <accdec/program/corner_limits.hpp>
#include <accdec/program/repair.hpp>

namespace accdec {
namespace {

ProgramPlan simulate_plan(const Toolpath& path, const LegFilters& filters, double sample_period, const Machine& machine,
                          std::vector<int> delays, bool blame) {
  ProgramPlan plan;
  plan.delays = std::move(delays);
  plan.errors.assign(path.blocks(), 0.0);
  const CommandTiming timing(path, sample_period, plan.delays);
  SimulationOptions options;
  if (!machine.axes.empty()) options.machine = &machine;
  options.blame = blame;
  plan.simulation = simulate_program(timing, filters, 0, path.blocks() - 1, plan.errors, options);
  plan.errors_hold = true;
  for (std::size_t b = 0; b + 1 < path.blocks() && plan.errors_hold; ++b) {
    plan.errors_hold = holds(plan.errors[b], path.tolerance[b]);
  }
  return plan;
}

}  // namespace

bool holds(double error, double bound) { return error <= bound * (1.0 + verification_tolerance) + position_floor; }

void limit_rapids(Toolpath& path, const Filter& filter, double sample_period, const Machine& machine) {
  if (machine.axes.empty()) return;
  const LegFilters filters(filter);
  const CornerLimits limits(filters, machine, sample_period);
  const std::size_t n = path.dimensions();
  std::vector<double> velocity(n);
  for (std::size_t b = 0; b < path.blocks(); ++b) {
    if (path.rapid[b] == 0) continue;
    const double* p = path.point(b);
    for (std::size_t i = 0; i < n; ++i) velocity[i] = (p[n + i] - p[i]) / path.duration[b];
    path.duration[b] /= limits.start_factor(0, velocity.data());
  }
}

void snap_durations(Toolpath& path, const Filter& filter, double sample_period, const Machine& machine) {
  constexpr double most = 1e-6;
  const LegFilters filters(filter);
  const CornerLimits limits(filters, machine, sample_period);
  const std::size_t n = path.dimensions();
  std::vector<double> velocity(n);
  for (std::size_t first = 0, b = 0; b < path.blocks(); first = ++b) {
    while (!ends_leg(path, b) && b + 1 < path.blocks()) ++b;
    double duration = 0.0;
    for (std::size_t i = first; i <= b; ++i) duration += path.duration[i];
    const double samples = duration / sample_period, whole = std::floor(samples);
    if (whole < 1.0 || samples - whole <= 1e-9 || samples - whole > most * samples) continue;
    const double factor = whole / samples;
    bool held = true;
    for (std::size_t i = first; i <= b && held; ++i) {
      const double* p = path.point(i);
      for (std::size_t a = 0; a < n; ++a) velocity[a] = (p[n + a] - p[a]) / (path.duration[i] * factor);
      held = limits.start_factor(0, velocity.data()) >= 1.0;
    }
    for (std::size_t i = first; i <= b && held; ++i) path.duration[i] *= factor;
  }
}

ProgramPlan check_program(const Toolpath& path, const LegFilters& filters, double sample_period, const Machine& machine,
                          std::vector<int> delays) {
  return simulate_plan(path, filters, sample_period, machine, std::move(delays), false);
}

ProgramPlan plan_program(Toolpath& path, const LegFilters& filters, double sample_period, const Machine& machine) {
  const std::vector<double> programmed = path.duration;
  PairwiseDelays pairwise = pairwise_delays(path, filters, sample_period, machine);
  std::vector<SlowedFeeds> too_fast = limit_feeds(path, filters, sample_period, machine, pairwise);
  for (const auto& [block, delay] : path.given) {
    int& d = pairwise.delays[block];
    d = std::max(d, static_cast<int>(std::lround(std::min(delay / sample_period, 1e9))));
  }
  const bool mend_limits = !machine.axes.empty();
  ProgramPlan plan = simulate_plan(path, filters, sample_period, machine, pairwise.delays, mend_limits);
  const auto count = [&] {
    for (std::size_t b = 0; b < path.blocks(); ++b) plan.slowed += path.duration[b] > programmed[b] ? 1 : 0;
    plan.too_fast = std::move(too_fast);
  };
  if (plan.errors_hold && plan.simulation.broken.empty()) {
    count();
    return plan;
  }
  Repair repair(path, filters, sample_period, mend_limits ? &machine : nullptr, plan.delays, plan.errors);
  RepairWork failing = repair.failing(plan.simulation.broken);
  int rounds = 0;
  while (!failing.empty()) {
    ++rounds;
    failing = repair.round(failing, 1 + rounds / 8);
  }
  for (std::size_t b = 0; b < path.blocks(); ++b) {
    if (plan.delays[b] > pairwise.delays[b]) repair.lower(b, pairwise.delays[b]);
  }
  plan = check_program(path, filters, sample_period, machine, std::move(plan.delays));
  plan.rounds = rounds;
  for (std::size_t b = 0; b < path.blocks(); ++b) {
    plan.raised += plan.delays[b] > pairwise.delays[b] ? 1 : 0;
  }
  count();
  return plan;
}

}  // namespace accdec
