#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/files/shown_text.hpp>
#include <accdec/files/units.hpp>
#include <accdec/machine/limit_unit.hpp>
#include <accdec/machine/mode_text.hpp>
#include <accdec/machine/position_unit.hpp>
#include <accdec/plan/feeds/radius_error.hpp>
#include <accdec/plan/filters/program_settings.hpp>
#include <accdec/plan/report/axis_loads.hpp>
#include <accdec/plan/report/left_at_rest.hpp>
#include <accdec/plan/report/leg_error.hpp>
#include <accdec/plan/report/plan_facts.hpp>
#include <accdec/plan/report/samples.hpp>
#include <accdec/program.hpp>
#include <accdec/task/not_considered.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

/// Two blanks before every line but the first.
std::string indented(std::string text) {
  for (std::size_t at = text.find('\n'); at + 1 < text.size(); at = text.find('\n', at + 1)) text.insert(at + 1, "  ");
  return text;
}

/// Limits of which bounds know nothing or only a part; empty if there are none.
std::string left_out_by_bounds(const Machine& machine) {
  std::vector<std::string> texts;
  const auto add = [&](bool limited, std::string text) {
    if (limited && std::find(texts.begin(), texts.end(), text) == texts.end()) texts.push_back(std::move(text));
  };
  for (const Axis& axis : machine.axes) {
    for (const AxisLimit& limit : axis_limits) {
      if (limit.kind != LimitKind::force && limit.kind != LimitKind::power && limit.kind != LimitKind::regeneration)
        continue;
      add(axis.*limit.bound < unlimited,
          limit_key(limit, axis.name) +
              (limit.kind == LimitKind::force ? ", but for the acceleration that it gives if friction helps" : ""));
    }
  }
  add(!machine.modes.empty(), "[[mode]]");
  return fmt::format("{}", fmt::join(texts, ", "));
}

class SummaryText {
 public:
  explicit SummaryText(const ProgramResult& result) : result_(result), left_at_rest_(left_at_rest(result)) {}

  std::string write() {
    if (!result_.verification.feasible) return broken_plan();
    if (const std::string answer = program_answer(result_); !answer.empty()) put("{}\n", answer);
    head();
    times();
    estimates();
    corners();
    feeds();
    limits();
    control();
    put("\n  ignored: {}\n", not_considered_text(moved_machine(result_), rated()));
    if (const std::string left_out = left_out_by_bounds(moved_machine(result_));
        !left_out.empty() && result_.corner_bound)
      put("  ignored by the bounds: {}\n", left_out);
    put("  planned and verified in {:.3g} s", result_.solver.wall_time);
    if (result_.peak_memory > 0) put(", at most {:.0f} MB of memory", static_cast<double>(result_.peak_memory) * 1e-6);
    put("\n");
    put("\n  verified: every sample simulated, {}{}{}\n", bounds_that_hold(left_at_rest_),
        result_.message.empty() ? "" : ": ", result_.message);
    return fmt::to_string(text_);
  }

 private:
  /// The limits of the plan that breaks least. Its times and settings are no answer.
  std::string broken_plan() {
    put("{}: no plan was found that holds all limits\n", printable(result_.program));
    limits();
    put("\n  NOT verified: {}\n", result_.message);
    return fmt::to_string(text_);
  }
  template <class... Arguments>
  void put(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    fmt::format_to(std::back_inserter(text_), format, std::forward<Arguments>(arguments)...);
  }

  void head() {
    const Toolpath& path = result_.plan.path;
    std::size_t inside = 0;  // they are no corners
    for (std::size_t b = 0; b + 1 < path.blocks() && result_.plan.command() != nullptr; ++b)
      inside += path.inside_arc[b] != 0 && result_.plan.delay(b) > 0 ? 1 : 0;
    put("{}: {} blocks in {} straight moves, {} corners, {} delayed, {} at rest{}\n", printable(result_.program),
        result_.programmed_blocks, result_.programmed_moves, result_.corners, result_.delayed, result_.at_rest,
        inside > 0 ? fmt::format("; {} points inside arcs delayed", inside) : "");
    const int taps = result_.plan.set().order() + 1;
    put("plan {}, {}, T = {:.6g} ms, {} samples\n\n", result_.plan.name(),
        result_.plan.command() != nullptr ? fmt::format("filter of {} taps", taps)
        : taps > 1                        ? fmt::format("last filter of {} taps", taps)
                                          : "no last filter",
        result_.sample_period * 1e3, result_.check.samples);
  }

  void times() {
    const auto row = [&](std::string_view what, double time) {
      put("  {:<28}{:>14.4f} s {:>9.2f} %\n", what, time, 100.0 * time / result_.cycle_time);
    };
    row("cycle time", result_.cycle_time);
    for (const PlanTime& other : result_.candidates) {
      // That of a plan which does not hold is no comparison.
      if (other.time > 0.0 && other.verified)
        row(describe(other), other.time);
      else
        put("  {}\n", describe(other));
      if (other.time > 0.0 && !other.broken.empty()) put("    it breaks {}\n", other.broken);
    }
    if (result_.plan.command() != nullptr) row("  of it delays", result_.delay_total);
    // The rows below are then those of the programmed feeds, too.
    const bool at_kept = result_.feeds_chosen && result_.cycle_time_kept;
    if (at_kept)
      row(result_.kept_same_filter ? "same filter, programmed feeds" : "feeds as programmed", *result_.cycle_time_kept);
    if (result_.cycle_time_exact_stop)
      row(at_kept ? "  with a stop at all corners" : "exact stop at every corner", *result_.cycle_time_exact_stop);
    if (!result_.exact_stop_breaks.empty()) put("    but breaks {}\n", result_.exact_stop_breaks);
    if (result_.cycle_time_no_delay)
      row(at_kept ? "  without delays at corners" : "no delay at any corner", *result_.cycle_time_no_delay);
    for (const NamedBound& bound : named_bounds(result_.lower_bound, result_.corner_bound)) {
      row("bound, " + bound.name, bound.time);
      put("    for {}\n", bound.motions);
    }
    if (!result_.filter_bound) return;
    row("bound, filters and delays", *result_.filter_bound);
    put("    for plans that keep the programmed feeds, with filters no longer than a block; others may be faster\n");
  }

  void estimates() {
    if (!result_.estimates.empty()) put("\n");
    for (const ControlEstimate& estimate : result_.estimates)
      put("  {}", indented(estimate_text(estimate, result_.cycle_time)));
  }

  void corners() {
    if (result_.worst_line == 0)
      put("\n  no corner {}\n", result_.plan.path.contour_max < unlimited
                                    ? "has a tolerance: the contour bounds the motion"
                                    : "grants a tolerance");
    else
      put("\n  largest corner error {:.3f} um; most of its tolerance used: {:.1f} % in line {}\n",
          result_.worst_error * 1e6, 100.0 * result_.worst_utilisation, result_.worst_line);
    const std::vector<CornerUse> worst = worst_corners(result_, result_.worst_shown);
    if (const auto& servo = result_.servo) {
      put("  errors are those behind the servo; {:.4g} s after the command, the motion is within {:.4g} um of its "
          "end\n",
          servo->settling, servo->within * 1e6);
      if (result_.plan.command()->moved.size() > 1)
        put("  {}\n  every sample is verified, nothing is proved of shorter plans\n", leg_error_text(result_));
      if (servo->stop_error > 0.0)
        put("  at stops the control waits for the command: the motion leaves out up to {:.4g} um\n",
            servo->stop_error * 1e6);
    }
    if (worst.empty()) return;
    put("\n  {:<14}{:>12}{:>14}{:>10}{:>9}\n", "worst corners", "error", "tolerance", "use", "delay");
    for (const CornerUse& corner : worst) {
      put("  {:<14}{:>9.3f} um{:>11.3f} um{:>8.1f} %{:>9}\n", fmt::format("line {}", corner.line), corner.error * 1e6,
          corner.tolerance * 1e6, 100.0 * corner.utilisation, corner.delay);
    }
    put("\n");
  }

  void feeds() {
    const Toolpath& path = result_.plan.path;
    if (result_.plan.trajectory() != nullptr) {
      put("  every sample has a speed of its own{}\n",
          result_.rounds > 0
              ? fmt::format("; {} rounds lowered it where a limit or a tolerance was broken", result_.rounds)
              : "");
    } else if (result_.feeds_chosen) {
      put("  feeds chosen: {} steps of the feed inside {} straight moves\n", path.blocks() - result_.programmed_moves,
          result_.programmed_moves);
    }
    if (!path.programmed.empty())
      put("  arcs commanded on radii larger by up to {:.3f} um\n", largest_widening(path) * 1e6);
    if (!result_.compensation.empty()) put("  {}\n", result_.compensation);
    if (!path.clamped.empty()) {
      put("  feeds above an axis' velocity limit are lowered to it in {} lines, the first {}\n", path.clamped.size(),
          path.clamped.front());
    }
    if (result_.raised > 0)
      put("  {} delays longer than their corners alone need, because moves overlap\n", result_.raised);
    std::size_t too_fast = 0;
    for (const SlowedFeeds& slowed : result_.too_fast) {
      too_fast += slowed.blocks;
      const bool on_legs = slowed.limit == to_string(LimitKind::contour);
      put("  {} blocks slowed to {} {}, most in line {} to {:.1f} % of its feed\n", slowed.blocks,
          on_legs ? "keep the" : "start and stop within", slowed.limit, slowed.line, 100.0 * slowed.factor);
    }
    if (result_.slowed > too_fast)
      put("  {} blocks slowed, on curves or too short for their feed\n", result_.slowed - too_fast);
  }

  static bool broken(double utilisation) { return utilisation > 1.0 + verification_tolerance; }

  /// Whether the program's path has axes that turn, and others.
  std::pair<bool, bool> kinds_of_axes() const {
    std::pair<bool, bool> kinds{false, false};
    const Toolpath& path = result_.plan.path;
    for (std::size_t a = 0; a < path.dimensions(); ++a)
      (is_rotary(path.axis_name(a)) ? kinds.first : kinds.second) = true;
    return kinds;
  }

  void control() {
    put("\n  a control must {}\n", fmt::join(control_needs(result_), ", "));
    // Each of four positions in a third difference is rounded by half a unit, with weights 1, 3, 3 and 1.
    if (const double unit = result_.task_machine.position_unit; unit > 0.0) {
      const std::pair<bool, bool> kinds = kinds_of_axes();
      const bool turning = kinds.first, moving = kinds.second;
      const auto either = [&](std::string_view linear, std::string_view rotary) {
        return fmt::format("{}{}{}", moving ? linear : "", moving && turning ? " or " : "", turning ? rotary : "");
      };
      put("  positions are whole numbers of {:g} {}; differences of them read up to {:.4g} {} more jerk\n", 1e6 * unit,
          either("um", "mdeg"), 4e3 * unit / std::pow(result_.sample_period, 3), either("mm/s^3", "deg/s^3"));
      const Toolpath& path = result_.plan.path;
      put("  rounding moves a position by up to {:.4g} {}: corner errors do not count it{}\n",
          1e6 * unit_rounding(result_.task_machine, path.dimensions()), either("um", "mdeg"),
          path.contour_max < unlimited ? ", the contour has room for it" : "");
    }
    for (const FeedOverride& at : result_.overrides) {
      put("  {:<28}", fmt::format("feed override {:.0f} %", 100.0 * at.factor));
      if (at.worst_line > 0 || at.limit.empty())
        put("corner error {:.3f} um, {:.1f} % of its tolerance{}", at.worst_error * 1e6, 100.0 * at.worst_utilisation,
            at.worst_line > 0 ? fmt::format(" in line {}", at.worst_line) : "");
      if (!at.limit.empty())
        put("{}{} used by {:.1f} %", at.worst_line > 0 ? "; " : "", at.limit, 100.0 * at.limit_utilisation);
      const bool error = broken(at.worst_utilisation), limit = broken(at.limit_utilisation);
      if (error || limit)
        put("\n    breaks {}{}{}", error ? "its tolerance" : "", error && limit ? " and " : "", limit ? at.limit : "");
      put("\n");
    }
  }

  /// Whether the ratings of all axes with a load were considered.
  std::vector<std::string> rated() const {
    std::vector<std::string> names;
    for (const AxisLoad& load : result_.loads) {
      if (load.rms_max < unlimited) names.push_back(load.axis);
    }
    return names;
  }

  /// Feeds are lowered until a rating is kept, and no farther than this.
  static bool binds(const AxisLoad& load) {
    constexpr double near = 0.995;
    return load.rms >= near * load.rms_max && load.rms <= load.rms_max * (1.0 + verification_tolerance);
  }

  /// No length of the chords follows from a contour of 0.
  void beside_arcs() {
    const Toolpath& path = result_.plan.path;
    if (path.contour_max > 0.0 || path.arcs.empty()) return;
    double most = 0.0;
    for (const PathArc& arc : path.arcs) most = std::max(most, sagitta_of(arc));
    put("  contour: that of the chords; they are up to {:.3f} um beside their arcs\n", most * 1e6);
  }

  void limits() {
    const std::vector<LimitUse>& uses = result_.check.limits;
    if (!uses.empty()) {
      put("\n  {:<14}{:<6}{:>12}{:>12} {:<8}{:>8}  {}\n", "limit", "axis", "value", "bound", "unit", "use", "where");
    }
    for (const LimitUse& use : uses) {
      const auto [unit, per_si] = limit_unit(use.kind, use.axis);
      put("  {:<14}{:<6}{:>12.6g}{:>12.6g} {:<8}{:>6.1f} %  {}\n", limit_word(use.kind, use.axis), use.axis,
          per_si * use.value, per_si * use.bound, unit, 100.0 * use.utilisation,
          use.kind == LimitKind::vibration ? place_of_vibration(use)
          : of_mode(use.kind)              ? fmt::format("line {}, {}", use.line, place_of_vibration(use, 4))
                                           : fmt::format("line {}", use.line));
    }
    if (std::ranges::any_of(uses, [](const LimitUse& use) { return use.kind == LimitKind::force_speed; }))
      put("  force speed: a sample's force and the curve's at its speed, both in proportion as at standstill\n");
    beside_arcs();
    for (const std::string& left_out : left_out_by_residuals(result_)) put("  {}\n", left_out);
    for (const std::string& left : left_at_rest_in_words(result_, left_at_rest_)) put("  {}\n", left);
    for (const AxisLoad& load : result_.loads) {
      const auto [unit, per_si] = limit_unit(LimitKind::force, load.axis);
      put("  {:<14}{:<6}{:>12.6g}{:>12.6g} {}, peak and root mean square over the program{}\n",
          limit_word(LimitKind::force, load.axis), load.axis, per_si * load.peak, per_si * load.rms, unit,
          load.rms_max < unlimited ? fmt::format(", {:.1f} % of its rating{}", 100.0 * load.rms / load.rms_max,
                                                 binds(load) ? ", which binds" : "")
                                   : "");
    }
  }

  const ProgramResult& result_;
  const std::vector<LeftAtRest> left_at_rest_;
  fmt::memory_buffer text_;
};

}  // namespace

std::string program_summary(const ProgramResult& result) {
  return SummaryText(result).write();
}

}  // namespace accdec
