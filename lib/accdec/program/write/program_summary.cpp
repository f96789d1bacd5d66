#include <algorithm>
#include <iterator>
#include <string_view>

#include <fmt/format.h>

#include <accdec/machine/limits.hpp>
#include <accdec/program/write/program_report.hpp>
#include <accdec/program/write/samples.hpp>

namespace accdec {
namespace {

/// Of a limit's value for people. Rotary axes are in degrees where the others are in millimetres.
std::string unit_of(const LimitUse& use) {
  std::string unit(limit_name(use.kind).unit);
  const bool rotary = use.axis.size() == 1 && std::string_view("ABCabc").find(use.axis[0]) != std::string_view::npos;
  if (rotary && unit.starts_with("mm")) unit.replace(0, 2, "deg");
  return unit;
}

class SummaryText {
 public:
  explicit SummaryText(const ProgramResult& result) : result_(result) {}

  std::string write() {
    head();
    times();
    corners();
    feeds();
    limits();
    if (result_.peak_memory > 0) {
      put("\n  planned and verified in {:.3g} s, at most {:.0f} MB of memory\n", result_.solver.wall_time,
          static_cast<double>(result_.peak_memory) * 1e-6);
    }
    put("\n  {}{}{}\n",
        result_.verification.feasible ? "verified: every sample simulated, all bounds hold" : "NOT verified",
        result_.message.empty() ? "" : ": ", result_.message);
    return fmt::to_string(text_);
  }

 private:
  template <class... Arguments>
  void put(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    fmt::format_to(std::back_inserter(text_), format, std::forward<Arguments>(arguments)...);
  }

  void head() {
    put("{}: {} blocks, {} corners, {} delayed, {} exact stops\n", result_.program, result_.programmed_blocks,
        result_.corners, result_.delayed, result_.exact_stops);
    std::string taps = fmt::format("filter of {} taps", result_.filter.order() + 1);
    if (!result_.legs.single()) {
      const auto [least, most] =
          std::minmax_element(result_.legs.filters().begin(), result_.legs.filters().end(),
                              [](const Filter& a, const Filter& b) { return a.order() < b.order(); });
      taps = fmt::format("{} filters of {} to {} taps, one a leg", result_.legs.filters().size(), least->order() + 1,
                         most->order() + 1);
    }
    put("{}, T = {:.6g} ms, {} samples\n\n", taps, result_.sample_period * 1e3, result_.plan.simulation.samples);
  }

  void times() {
    const auto row = [&](std::string_view what, double time) {
      put("  {:<28}{:>14.4f} s{:>10.2f} %\n", what, time, 100.0 * time / result_.cycle_time);
    };
    row("cycle time", result_.cycle_time);
    for (const PlanTime& other : result_.candidates) row(describe(other), other.time);
    row("  of it delays", result_.delay_total);
    if (!result_.legs.single()) row("one filter for all legs", result_.cycle_time_one_filter);
    if (result_.feeds_chosen && result_.cycle_time_kept) row("feeds as programmed", *result_.cycle_time_kept);
    row("exact stop at every corner", result_.cycle_time_exact_stop);
    if (!result_.exact_stop_breaks.empty()) put("    but breaks {}\n", result_.exact_stop_breaks);
    row("no delay at any corner", result_.cycle_time_no_delay);
    row("bound, continuous motion", result_.lower_bound);
    if (result_.corner_bound) {
      row("bound, corners", result_.corner_bound->time);
      put("    {}\n", describe(*result_.corner_bound));
    }
    if (result_.filter_bound) row("bound, filters and delays", *result_.filter_bound);
  }

  void corners() {
    put("\n  largest corner error {:.3f} um; most of its tolerance used: {:.1f} % in line {}\n",
        result_.worst_error * 1e6, 100.0 * result_.worst_utilisation, result_.worst_line);
    const std::vector<CornerUse> worst = worst_corners(result_, result_.worst_shown);
    if (worst.empty()) return;
    put("\n  {:<14}{:>12}{:>14}{:>10}{:>9}\n", "worst corners", "error", "tolerance", "use", "delay");
    for (const CornerUse& corner : worst) {
      put("  {:<14}{:>9.3f} um{:>11.3f} um{:>8.1f} %{:>9}\n", fmt::format("line {}", corner.line), corner.error * 1e6,
          corner.tolerance * 1e6, 100.0 * corner.utilisation, corner.delay);
    }
    put("\n");
  }

  void feeds() {
    const ProgramPlan& plan = result_.plan;
    if (result_.feeds_chosen) {
      put("  feeds chosen, in {} steps inside {} blocks\n", result_.path.blocks() - result_.programmed_blocks,
          result_.programmed_blocks);
    }
    if (!result_.path.programmed.empty()) {
      put("  arcs commanded on radii larger by up to {:.3f} um\n", widest(result_.path) * 1e6);
    }
    if (!result_.path.clamped.empty()) {
      put("  feeds above an axis' velocity limit lowered to it in {} lines, the first {}\n",
          result_.path.clamped.size(), result_.path.clamped.front());
    }
    if (result_.raised > 0)
      put("  {} delays longer than their corners alone need, because moves overlap\n", result_.raised);
    std::size_t too_fast = 0;
    for (const SlowedFeeds& slowed : plan.too_fast) {
      too_fast += slowed.blocks;
      put("  {} blocks slowed to start and stop within {}, most in line {} to {:.1f} % of its feed\n", slowed.blocks,
          slowed.limit, slowed.line, 100.0 * slowed.factor);
    }
    if (plan.slowed > too_fast)
      put("  {} blocks slowed, on curves or too short for their feed\n", plan.slowed - too_fast);
  }

  void limits() {
    const std::vector<LimitUse>& uses = result_.plan.simulation.limits;
    if (!uses.empty()) {
      put("\n  {:<14}{:<6}{:>12}{:>12} {:<8}{:>8}  {}\n", "limit", "axis", "value", "bound", "unit", "use", "where");
    }
    for (const LimitUse& use : uses) {
      const double per_si = limit_name(use.kind).per_si;
      put("  {:<14}{:<6}{:>12.6g}{:>12.6g} {:<8}{:>6.1f} %  {}\n", to_string(use.kind), use.axis, per_si * use.value,
          per_si * use.bound, unit_of(use), 100.0 * use.utilisation,
          use.kind == LimitKind::vibration ? fmt::format("{:.6g} Hz", use.frequency) : use.corner);
    }
  }

  const ProgramResult& result_;
  fmt::memory_buffer text_;
};

}  // namespace

std::string program_summary(const ProgramResult& result) {
  return SummaryText(result).write();
}

}  // namespace accdec
