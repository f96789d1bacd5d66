#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include <accdec/design/verify_settings.hpp>
#include <accdec/machine/limit_unit.hpp>
#include <accdec/machine/limits.hpp>
#include <accdec/machine/mode_text.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/plan/feeds/control_delay.hpp>
#include <accdec/plan/report/left_at_rest.hpp>
#include <accdec/plan/verify/judge_program.hpp>
#include <accdec/plan/verify/own_trajectory.hpp>
#include <accdec/plan/verify/used_limits.hpp>
#include <accdec/plan/verify/verify_delay_kinds.hpp>
#include <accdec/plan/verify/verify_path.hpp>
#include <accdec/plan/verify/verify_program_result.hpp>
#include <accdec/simulate/arc_points.hpp>
#include <accdec/simulate/contour_watch.hpp>
#include <accdec/simulate/direct.hpp>
#include <accdec/simulate/profile_motion.hpp>
#include <accdec/simulate/sample_check.hpp>
#include <accdec/simulate/simulate.hpp>
#include <accdec/simulate/tube_check.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

bool close(double a, double b, double floor) {
  return std::abs(a - b) <= rounding * std::abs(b) + floor;
}

/// The plan of a result and its names, from which a recheck starts.
ProgramResult recorded_plan(const ProgramResult& result) {
  ProgramResult plan;
  plan.program = result.program;
  plan.sample_period = result.sample_period;
  plan.plan = result.plan;
  return plan;
}

/// The control's own smoothing behind a filter, which the plan's is made without.
Filter smoothed(const Filter& set, const std::vector<double>& smoothing) {
  if (smoothing.empty()) return set;
  std::vector<double> taps(static_cast<std::size_t>(set.order()) + smoothing.size(), 0.0);
  for (std::size_t k = 0; k < taps.size(); ++k) {
    for (std::size_t j = 0; j < smoothing.size() && j <= k; ++j) {
      if (k - j <= static_cast<std::size_t>(set.order())) taps[k] += smoothing[j] * set.tap(static_cast<int>(k - j));
    }
  }
  return Filter(std::move(taps));
}

/// The filters, and how long the servos of the axes behind them take.
BlockFilters with_servo(BlockFilters filters, const Machine& machine, double period) {
  filters.behind = Response(machine, period).servo_order();
  return filters;
}

class CommandCheck {
 public:
  CommandCheck(const ProgramResult& result, const Task& task, const std::optional<BlockFilters>& filters)
      : result_(result),
        path_(result.plan.path),
        command_(*result.plan.command()),
        task_(task),
        per_leg_(filters.has_value()),
        filter_(smoothed(command_.set(), task.machine.prefilter_taps)),
        machine_(program_machine(task.machine, path_)),
        filters_(with_servo(filters.value_or(BlockFilters{{filter_}, {}}), machine_, result.sample_period)) {}

  ProgramResultCheck run() {
    const DirectMotion motion = direct_motion(path_, result_.sample_period, command_.delays, filters_);
    std::optional<DirectMotion> servo;
    if (has_servo(machine_)) servo = behind_servos(motion, machine_, result_.sample_period);
    const DirectMotion& behind = servo ? *servo : motion;
    const double time = static_cast<double>(motion.samples) * result_.sample_period;
    check_filter();
    check_delay_kinds(result_, task_, filter_, motion, report_.reasons);
    check_joints(behind);
    check_limits(motion, behind);
    check_ratings(behind);
    check_servo(behind);
    check_arcs(behind);
    check_vibration();
    describe(motion, time);
    report_.accepted = report_.reasons.empty();
    report_.shown = fmt::format("{} samples of {} commanded moves simulated again, {:.6g} s: {}", motion.samples,
                                path_.blocks(), time, bounds_that_hold(left_at_rest(report_.found)));
    return std::move(report_);
  }

 private:
  void wrong(std::string reason) {
    if (report_.reasons.size() < most_reasons) report_.reasons.push_back(std::move(reason));
  }

  void check_servo(const DirectMotion& motion) {
    if (!result_.servo) return;
    const double recorded = result_.servo->settling, period = result_.sample_period;
    const double found =
        period * static_cast<double>(direct_settling(motion, path_, result_.servo->within * (1.0 + rounding)));
    if (std::abs(recorded - found) > 1.5 * period)
      wrong(fmt::format("servo.settling_s is recorded as {:.9g}, found {:.9g}", recorded, found));
    if (!result_.servo->legs) return;
    const int felt = FilterBehind(filter_, machine_, period).felt_order();
    const std::map<std::uint32_t, double> legs = off_legs(motion, path_, filters_.order_max() + filters_.behind, felt);
    double most = 0.0;
    for (const auto& [line, off] : legs) most = std::max(most, off);
    const auto& [error, line] = *result_.servo->legs;
    if (!close(error, most, position_rounding))
      wrong(fmt::format("servo.leg_error_m is recorded as {:.9g}, found {:.9g}", error, most));
    else if (!legs.contains(line) || !close(legs.at(line), most, position_rounding))
      wrong(fmt::format("servo.leg_line is recorded as {}, where the motion is not as far off", line));
  }

  void check_filter() {
    const bool families = task_.settings && task_.settings->names_family();
    const bool taps = task_.settings && !families && has_settings(*task_.settings);
    if (result_.today.value_or(unlimited) < result_.lower_bound * (1.0 - rounding))
      wrong("today_s is below the bound of any motion");
    if (result_.settings && !families && !taps) return wrong("settings are recorded, the task asks for none");
    if (result_.settings && taps && result_.settings->chosen.family != SettingFamily::taps)
      return wrong("the task's control takes taps, another family is recorded");
    if (result_.settings && result_.settings->free_taps.value_or(unlimited) < result_.lower_bound * (1.0 - rounding))
      wrong("settings.free_taps_s is below the bound of any filter");
    if (result_.settings && families)
      return compare_setting(task_, result_.settings->chosen, command_.set(), report_.reasons);
    // Else the program brought its filter along, or the task gives it.
    if (families || !task_.filter) return;
    const Filter given = make_filter(*task_.filter);
    const auto own = command_.set().taps(), asked = given.taps();
    const bool same = std::equal(own.begin(), own.end(), asked.begin(), asked.end(),
                                 [](double a, double b) { return std::abs(a - b) <= 1e-12; });
    if (!same) wrong("the taps are not those of the task's filter");
  }

  void check_joints(const DirectMotion& motion) {
    const Toolpath& path = path_;
    for (std::size_t b = 0; b + 1 < path.blocks(); ++b) {
      const double found = direct_error(motion, path, b), recorded = result_.errors[b];
      if (!close(recorded, found, position_rounding))
        wrong(fmt::format("line {}: corner error is recorded as {:.9g} m, found {:.9g} m", path.line[b], recorded,
                          found));
      if (found > path.tolerance[b] * (1.0 + rounding) + position_rounding)
        wrong(fmt::format("line {}: corner error {:.9g} m exceeds its tolerance {:.9g} m", path.line[b], found,
                          path.tolerance[b]));
    }
  }

  /// The limits of axes stand first, in the order of the axes and of the table of limits; then those of the supply.
  void check_limits(const DirectMotion& command, const DirectMotion& motion) {
    std::size_t i = 0;
    for (std::size_t a = 0; a < machine_.axes.size(); ++a) {
      for (const AxisLimit& limit : axis_limits) {
        const Axis& axis = machine_.axes[a];
        if (axis.*limit.bound < unlimited)
          check_limit(i++, use_of_axis(limit.load ? motion : command, axis, a, limit.kind, result_.sample_period),
                      axis.name);
      }
    }
    for (const SupplyLimit& limit : supply_limits) {
      if (machine_.*limit.bound < unlimited)
        check_limit(i++, use_of_supply(motion, machine_, limit.kind, result_.sample_period), "");
    }
    if (path_.contour_max < unlimited)
      check_limit(i++, use_of_contour(motion, path_, filters_.order_max() + filters_.behind), "");
    for (const Mode& mode : machine_.modes) {
      if (mode.of_axis())
        check_limit(i++, use_of_mode(command, path_, result_.sample_period, command_.delays, filter_, mode),
                    machine_.axes[static_cast<std::size_t>(mode.axis)].name);
    }
    limits_ = i;
  }

  void check_ratings(const DirectMotion& motion) {
    for (std::size_t a = 0; a < machine_.axes.size(); ++a) {
      const Axis& axis = machine_.axes[a];
      if (!(axis.force_rms_max < unlimited)) continue;
      const double rms = rms_force(motion, axis, a, result_.sample_period);
      if (rms > axis.force_rms_max * (1.0 + rounding))
        wrong(fmt::format("root mean square of the force {} is {:.9g} N, above its rating {:.9g} N", axis.name, rms,
                          axis.force_rms_max));
    }
  }

  void check_arcs(const DirectMotion& motion) {
    ArcPoints arcs(path_, !result_.plan.command()->moved.empty());
    for (std::size_t i = 0; i < arcs.count(); ++i) {
      const std::size_t b = arcs.block(i);
      const std::int64_t first = b > 0 ? motion.windows[b - 1].first : 0;
      const std::int64_t last =
          b < motion.windows.size() ? motion.windows[b].last : std::ssize(motion.position.front()) - 1;
      arcs.set_distance(i, direct_distance(motion, arcs.point(i), first, last, true));
    }
    arcs_ = arcs.worst();
  }

  void check_limit(std::size_t i, const UseOfLimit& use, const std::string& axis) {
    const std::string name = fmt::format("{}{}{}", to_string(use.kind()), axis.empty() ? "" : " ", axis);
    const UseOfLimit::Worst found = use.worst();
    if (found.use > 1.0 + rounding && found.value > use.bound() * (1.0 + rounding) + use.floor())
      wrong(fmt::format("{} is broken: {:.6g} %", name, 100.0 * found.use));
    const auto& limits = result_.check.limits;
    if (i >= limits.size() || limits[i].kind != use.kind() || limits[i].axis != axis)
      return wrong(fmt::format("limits[{}] should be {}", i, name));
    const LimitUse& recorded = limits[i];
    if (const std::string then = unit_of_before(use.kind(), axis, recorded.bound, use.bound()); !then.empty())
      return std::ranges::count(report_.reasons, then) > 0 ? void() : wrong(then);
    // That of an axis that turns was converted to rad and back.
    if (std::abs(recorded.bound - use.bound()) > (is_rotary(axis) ? 1e-15 * use.bound() : 0.0))
      wrong(fmt::format("{}: bound is recorded as {:.9g}, the task's is {:.9g}", name, recorded.bound, use.bound()));
    // The planner looks for the largest distance down to the precision of positions.
    const double floor = rounding + (use.bound() > 0.0 ? use.floor() / use.bound() : 0.0);
    if (!close(recorded.value, found.value, rounding * use.bound() + use.floor()))
      wrong(fmt::format("{}: value is recorded as {:.9g}, found {:.9g}", name, recorded.value, found.value));
    if (!close(recorded.utilisation, found.use, floor))
      wrong(fmt::format("{}: utilisation is recorded as {:.9g}, found {:.9g}", name, recorded.utilisation, found.use));
    if (!use.is_worst(recorded.sample, found))
      wrong(fmt::format("{}: is not used most at sample {}", name, recorded.sample));
    check_line(i, name);
  }

  /// Lines come from the simulation of the plan. If several samples use a limit equally, it may find
  /// another of them than was recorded. Plans per leg are no longer simulated.
  void check_line(std::size_t i, const std::string& name) {
    const std::uint32_t recorded = result_.check.limits[i].line;
    if (lines_.limits.empty() && !per_leg_) lines_ = simulated();
    if (per_leg_ || lines_.limits[i].sample != result_.check.limits[i].sample) {
      if (std::find(path_.line.begin(), path_.line.end(), recorded) == path_.line.end())
        wrong(fmt::format("{}: line is recorded as {}, which the program does not have", name, recorded));
    } else if (lines_.limits[i].line != recorded) {
      wrong(fmt::format("{}: line is recorded as {}, found {}", name, recorded, lines_.limits[i].line));
    }
  }

  Simulation simulated() const {
    std::vector<double> errors(path_.blocks());
    SimulationOptions options;
    options.machine = &machine_;
    const FilterBehind behind(filter_, machine_, result_.sample_period);
    options.motion = behind.servo();
    return simulate_program(CommandTiming(path_, result_.sample_period, command_.delays), filter_, 0,
                            path_.blocks() - 1, errors, options);
  }

  void check_vibration() {
    for (const Filter& filter : filters_.filters) {
      for (const LimitUse& use : vibration_utilisation(filter, result_.sample_period, task_.machine)) {
        if (use.utilisation > 1.0 + verification_tolerance)
          wrong(fmt::format("vibration {}: {:.6g} % of its bound", place_of_vibration(use), 100.0 * use.utilisation));
      }
    }
  }

  /// All that follows from the commands, and from errors and uses of limits, which were compared above.
  void describe(const DirectMotion& motion, double time) {
    ProgramResult& found = report_.found;
    found = recorded_plan(result_);
    found.task_machine = task_.machine;
    found.errors = result_.errors;
    found.check.errors_hold = true;  // or there is a reason
    found.check.samples = motion.samples;
    found.check.limits = result_.check.limits;
    found.check.limits.resize(std::min(limits_, found.check.limits.size()));
    found.cycle_time = time;
    found.arcs = arcs_;
    judge_program(found, machine_);
    if (per_leg_) take_worst_vibration(found);
  }

  /// The worst use by any of the filters.
  void take_worst_vibration(ProgramResult& found) const {
    for (const Filter& filter : filters_.filters) {
      const std::vector<LimitUse> uses = vibration_utilisation(filter, result_.sample_period, task_.machine);
      for (std::size_t i = 0; i < uses.size() && limits_ + i < found.check.limits.size(); ++i) {
        LimitUse& worst = found.check.limits[limits_ + i];
        if (uses[i].utilisation > worst.utilisation) worst = uses[i];
      }
    }
  }

  const ProgramResult& result_;
  const Toolpath& path_;
  const FilteredCommand& command_;
  const Task& task_;
  const bool per_leg_;
  const Filter filter_;  // that is set, and the control's own smoothing behind it
  const Machine machine_;
  const BlockFilters filters_;
  ProgramResultCheck report_;
  std::optional<ArcError> arcs_;
  std::size_t limits_ = 0;  // of axes
  Simulation lines_;        // made when first asked for
};

/// The samples of a trajectory, looked at one by one. Says what a free motion breaks beside limits and tolerances of
/// joints.
SampleCheck look_at(const Plan& plan, double period, const Machine& machine, std::vector<double>& errors,
                    std::string& broken) {
  const Toolpath& path = plan.path;
  const Trajectory& trajectory = *plan.trajectory();
  SampleChecker checker(path, machine, period, errors, {});
  const auto finish = [&] {
    SampleCheck check = checker.finish();
    if (path.contour_max < unlimited) check.limits.push_back(contour_of(path, trajectory, period).use());
    return check;
  };
  if (!trajectory.is_free()) {
    ProfileMotion motion(path, trajectory.chain, period, trajectory.last);
    for (; motion.next(); checker.pass(motion.pass_steady(), motion.position()))
      checker.look(motion.position(), motion.place_first(), motion.place_last());
    return finish();
  }
  TubeCheck tube(path, period);
  for (std::size_t k = 0; k < trajectory.free.block.size(); ++k) {
    const double* position = trajectory.free.position.data() + k * path.dimensions();
    const std::size_t block = trajectory.free.block[k];
    checker.look(position, 2 * static_cast<std::int64_t>(block), 2 * static_cast<std::int64_t>(block));
    tube.look(position, block);
  }
  broken = tube.finish();
  return finish();
}

}  // namespace

std::string judge_trajectory(ProgramResult& result, const Machine& machine) {
  std::string broken;
  result.errors.assign(result.plan.path.blocks(), 0.0);
  result.check = look_at(result.plan, result.sample_period, machine, result.errors, broken);
  result.cycle_time = static_cast<double>(result.check.samples) * result.sample_period;
  judge_program(result, machine);
  return broken.empty() ? result.message : broken;
}

namespace {

/// The contour and the ratings again, by other formulas.
void compare_own(const ProgramResult& found, const Machine& machine, std::vector<std::string>& reasons) {
  const OwnTrajectory own = own_trajectory(found.plan, found.sample_period, machine);
  const auto wrong = [&](const std::string& what, double made, double value) {
    reasons.push_back(fmt::format("{} is {:.9g}, by the formulas of the planner {:.9g}", what, value, made));
  };
  for (const LimitUse& use : found.check.limits) {
    if (use.kind != LimitKind::contour) continue;
    const double floor = rounding * use.bound + 2.0 * position_floor;
    if (!close(use.value, own.contour, floor)) wrong("contour", use.value, own.contour);
    if (own.contour > use.bound + floor)
      reasons.push_back(fmt::format("contour {:.9g} m exceeds its bound {:.9g} m", own.contour, use.bound));
  }
  for (std::size_t a = 0; a < machine.axes.size(); ++a) {
    const double rating = machine.axes[a].force_rms_max, rms = own.rms[a];
    const std::string name = "root mean square of the force " + found.plan.path.axis_name(a);
    for (const AxisLoad& load : found.loads) {
      if (load.axis == found.plan.path.axis_name(a) && !close(load.rms, rms, rounding)) wrong(name, load.rms, rms);
    }
    if (rms > rating * (1.0 + rounding))
      reasons.push_back(fmt::format("{} is {:.9g} N, above its rating {:.9g} N", name, rms, rating));
  }
}

ProgramResultCheck check_trajectory(const ProgramResult& result, const Task& task) {
  const Toolpath& path = result.plan.path;
  const Machine machine = program_machine(task.machine, path);
  ProgramResultCheck report;
  ProgramResult& found = report.found;
  found = recorded_plan(result);
  found.errors.resize(path.blocks());
  std::string broken;
  found.check = look_at(result.plan, result.sample_period, machine, found.errors, broken);
  found.cycle_time = static_cast<double>(found.check.samples) * result.sample_period;
  judge_program(found, machine);
  for (std::size_t b = 0; b < path.blocks(); ++b) {
    if (close(result.errors[b], found.errors[b], position_rounding)) continue;
    report.reasons.push_back(fmt::format("line {}: corner error is recorded as {:.9g} m, found {:.9g} m", path.line[b],
                                         result.errors[b], found.errors[b]));
    break;
  }
  if (!found.message.empty()) report.reasons.push_back(found.message);
  if (!broken.empty()) report.reasons.push_back(broken);
  if (report.reasons.empty()) compare_own(found, machine, report.reasons);
  report.accepted = report.reasons.empty();
  report.shown = fmt::format("{} samples of {} moves made again, {:.6g} s: all bounds hold", found.check.samples,
                             path.blocks(), found.cycle_time);
  return report;
}

}  // namespace

ProgramResultCheck verify_program_result(const ProgramResult& result, const Task& task,
                                         const std::optional<BlockFilters>& filters) {
  if (result.plan.trajectory() != nullptr) return check_trajectory(result, task);
  return CommandCheck(result, task, filters).run();
}

}  // namespace accdec
