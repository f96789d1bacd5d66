#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

#include <fmt/format.h>

#include <accdec/machine/mode_text.hpp>
#include <accdec/plan/delays/pairwise_delays.hpp>
#include <accdec/plan/report/arc_error.hpp>
#include <accdec/plan/report/axis_loads.hpp>
#include <accdec/plan/report/feed_override.hpp>
#include <accdec/plan/report/servo_report.hpp>
#include <accdec/program.hpp>
#include <accdec/simulate/sample_check.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

/// Adds the use of every vibration bound by the plan's filter.
void add_vibration(ProgramResult& result, const Machine& machine) {
  for (const LimitUse& use : vibration_utilisation(result.plan.filter(), result.sample_period, machine))
    result.check.limits.push_back(use);
}

void judge_limits(ProgramResult& result) {
  const std::vector<LimitUse>& limits = result.check.limits;
  VerificationReport& report = result.verification;
  report.performed = true;
  report.tolerance = verification_tolerance;
  double worst = 0.0;
  for (const LimitUse& use : limits) {
    if (use.utilisation <= worst) continue;
    worst = use.utilisation;
    report.worst = use.kind == LimitKind::vibration
                       ? fmt::format("vibration: {:.1f} % {}", 100.0 * use.utilisation, place_of_vibration(use))
                       : fmt::format("{}: {:.1f} % at sample {}, line {}", limit_and_axis(use), 100.0 * use.utilisation,
                                     use.sample, use.line);
  }
  if (result.worst_utilisation > worst) {
    worst = result.worst_utilisation;
    report.worst = fmt::format("corner error: {:.1f} % of its tolerance, line {}", 100.0 * worst, result.worst_line);
  }
  const bool on_arcs = !result.arcs || holds(result.arcs->error, result.arcs->tolerance);
  if (!on_arcs) {
    const double use = utilisation_of(LimitKind::corner_error, result.arcs->error, result.arcs->tolerance);
    worst = std::max(worst, use);
    report.worst =
        fmt::format("distance from an arc: {:.1f} % of its tolerance, line {}", 100.0 * use, result.arcs->line);
  }
  bool rated = true;
  for (const AxisLoad& load : result.loads) {
    const double use = load.rms / load.rms_max;
    rated = rated && use <= 1.0 + verification_tolerance;
    if (use <= worst) continue;
    worst = use;
    report.worst = fmt::format("root mean square of the force {}: {:.1f} % of its rating", load.axis, 100.0 * use);
  }
  report.max_violation = std::max(0.0, worst - 1.0);
  result.check.limits_hold = std::all_of(limits.begin(), limits.end(), [](const LimitUse& use) {
    return use.utilisation <= 1.0 + verification_tolerance;
  });
  report.feasible = result.check.errors_hold && result.check.limits_hold && on_arcs && rated;
  result.status = report.feasible ? Status::feasible : Status::failed;
  if (!report.feasible) result.message = "a limit is broken: " + report.worst;
}

/// Errors below what positions can tell are none; neither are those of the stops of a trajectory, which waits there.
double error_of(const ProgramResult& result, std::size_t b) {
  const bool reached = result.plan.trajectory() != nullptr && result.plan.path.joint[b] == Joint::stop;
  return reached || result.errors[b] <= position_floor ? 0.0 : result.errors[b];
}

void count_joints(ProgramResult& result) {
  const Plan& plan = result.plan;
  const Toolpath& path = plan.path;
  for (std::size_t b = 0; b + 1 < path.blocks(); ++b) {
    const int delay = plan.delay(b);
    result.delay_total += delay * result.sample_period;
    if (path.joint[b] == Joint::straight && delay == 0) continue;
    if (path.inside_arc[b] == 0) {
      ++result.corners;
      result.delayed += delay > 0 ? 1 : 0;
      result.at_rest += rests_after(plan, b) ? 1 : 0;
    }
    if (!(path.tolerance[b] < unlimited)) continue;
    const double error = error_of(result, b);
    result.worst_error = std::max(result.worst_error, error);
    const double use = utilisation_of(LimitKind::corner_error, error, path.tolerance[b]);
    if (use > result.worst_utilisation || result.worst_line == 0) {
      result.worst_utilisation = use;
      result.worst_line = path.line[b];
    }
  }
}

}  // namespace

void judge_program(ProgramResult& result, const Machine& machine, const std::vector<int>& alone) {
  count_joints(result);
  if (const FilteredCommand* command = result.plan.command())
    result.raised =
        raised_delays(result.plan.path, command->filter, result.sample_period, machine, command->delays, alone);
  add_vibration(result, machine);
  if (result.plan.path.blocks() <= several_plans_max || has_ratings(machine))
    result.loads = axis_loads(result, machine);
  if (result.plan.path.blocks() <= several_plans_max && !result.arcs)
    result.arcs = arc_error(result.plan, result.sample_period);
  judge_limits(result);
  if (result.plan.path.blocks() <= several_plans_max) result.servo = servo_report(result);
  const FilteredCommand* command = result.plan.command();
  if (command != nullptr && result.plan.path.blocks() <= several_plans_max)
    result.overrides =
        feed_overrides(result.plan.path, command->filter, result.sample_period, machine, command->delays);
}

std::vector<std::string> control_needs(const ProgramResult& result) {
  if (result.plan.trajectory() != nullptr) {
    return {
        fmt::format("take a position of every axis every {:.6g} ms; an override that slows its clock keeps the path",
                    1e3 * result.sample_period)};
  }
  std::vector<std::string> needs;
  if (const std::size_t moves = result.plan.path.blocks(); result.feeds_chosen && moves > result.programmed_moves)
    needs.push_back(fmt::format("step its feed inside blocks ({} steps)", moves - result.programmed_moves));
  needs.push_back(fmt::format("filter all axes alike ({} taps)", result.plan.set().order() + 1));
  // Exact stops are waited for by every control; chords of arcs may need a delay, too.
  std::size_t held = 0;
  for (std::size_t b = 0; b + 1 < result.plan.path.blocks(); ++b)
    held += result.plan.path.joint[b] != Joint::stop && result.plan.delay(b) > 0 ? 1 : 0;
  if (held > 0)
    needs.push_back(fmt::format("delay the command at {} corners by whole samples, before the filter", held));
  return needs;
}

bool rests_after(const Plan& plan, std::size_t block) {
  if (plan.path.joint[block] == Joint::stop) return true;
  const FilteredCommand* command = plan.command();
  if (command == nullptr) return !plan.trajectory()->is_free() && plan.trajectory()->chain.stops(block + 1);
  return command->delays[block] >= std::max(1, exact_stop_of(command->filter));
}

std::size_t blocks_of(const Toolpath& programmed) {
  return static_cast<std::size_t>(std::count(programmed.inside_arc.begin(), programmed.inside_arc.end(), 0));
}

double largest_widening(const Toolpath& path) {
  double most = 0.0;
  const std::size_t n = path.dimensions();
  for (std::size_t i = 0; i <= path.blocks() && !path.programmed.empty(); ++i) {
    double sum = 0.0;
    for (std::size_t a = 0; a < n; ++a)
      sum += (path.point(i)[a] - path.programmed_point(i)[a]) * (path.point(i)[a] - path.programmed_point(i)[a]);
    most = std::max(most, std::sqrt(sum));
  }
  return most;
}

std::vector<CornerUse> worst_corners(const ProgramResult& result, std::size_t count) {
  // Sorted, never more than `count`: programs have many joints, few of which are among the worst.
  std::vector<CornerUse> worst;
  const auto offer = [&](const CornerUse& corner) {
    if (worst.size() == count && corner.utilisation <= worst.back().utilisation) return;
    if (worst.size() == count) worst.pop_back();
    const auto after = std::upper_bound(worst.begin(), worst.end(), corner.utilisation,
                                        [](double use, const CornerUse& other) { return use > other.utilisation; });
    worst.insert(after, corner);
  };
  std::optional<CornerUse> of_line;
  const Toolpath& path = result.plan.path;
  for (std::size_t b = 0; b + 1 < path.blocks() && count > 0; ++b) {
    if (!(path.tolerance[b] < unlimited)) continue;
    const double error = error_of(result, b);
    const double use = utilisation_of(LimitKind::corner_error, error, path.tolerance[b]);
    const CornerUse corner{path.line[b], error, path.tolerance[b], use, result.plan.delay(b)};
    if (of_line && of_line->line != corner.line) offer(*of_line);
    if (!of_line || of_line->line != corner.line || use > of_line->utilisation) of_line = corner;
  }
  if (of_line) offer(*of_line);
  return worst;
}

std::string delays_to_csv(const ProgramResult& result) {
  fmt::memory_buffer text;
  const auto put = std::back_inserter(text);
  fmt::format_to(put, "line,delay_samples,corner_error_m,error_max_m\n");
  const Toolpath& path = result.plan.path;
  for (std::size_t b = 0; b + 1 < path.blocks(); ++b) {
    if (path.joint[b] == Joint::straight && result.plan.delay(b) == 0) continue;
    const double error = error_of(result, b);
    fmt::format_to(put, "{},{},{:.9g},", path.line[b], result.plan.delay(b), error);
    if (path.tolerance[b] < unlimited) fmt::format_to(put, "{:.9g}", path.tolerance[b]);
    fmt::format_to(put, "\n");
  }
  return fmt::to_string(text);
}

}  // namespace accdec
