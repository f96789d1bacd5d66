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
#include <accdec/plan/report/plan_facts.hpp>
#include <accdec/plan/report/servo_report.hpp>
#include <accdec/plan/verify/judge_program.hpp>
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
  if (result.plan.path.blocks() <= several_plans_max) result.servo = servo_report(result, machine);
  const FilteredCommand* command = result.plan.command();
  if (command != nullptr && result.plan.path.blocks() <= several_plans_max)
    result.overrides =
        feed_overrides(result.plan.path, command->filter, result.sample_period, machine, command->delays);
}

}  // namespace accdec
