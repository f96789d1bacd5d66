#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include <accdec/machine/limits.hpp>
#include <accdec/program/simulate/direct.hpp>
#include <accdec/program/simulate/simulate.hpp>
#include <accdec/program/write/verify_program_result.hpp>
#include <accdec/task/verifier.hpp>

namespace accdec {
namespace {

/// Jerk is a third difference of positions that two summations round differently.
constexpr double rounding = 1e-7;
constexpr double position_rounding = 1e-9;  // m

bool close(double a, double b, double floor) {
  return std::abs(a - b) <= rounding * std::abs(b) + floor;
}

/// Worst use of one limit of an axis over the whole motion.
struct Worst {
  double use = 0.0, value = 0.0;
};

/// One axis limit as the motion uses it, sample by sample.
class UseOfLimit {
 public:
  UseOfLimit(const DirectMotion& motion, const Axis& axis, std::size_t a, const AxisLimit& limit, double period)
      : velocity_(motion.velocity[a]), axis_(axis), limit_(limit), period_(period) {}

  double bound() const { return axis_.*limit_.bound; }
  double value_at(std::size_t k) const {
    const auto v = [&](std::size_t back) { return back > k ? 0.0 : velocity_[k - back]; };
    const double acceleration = (v(0) - v(1)) / period_, before = (v(1) - v(2)) / period_;
    return limit_.value(axis_state(axis_, v(0), acceleration, (acceleration - before) / period_));
  }
  Worst worst() const {
    Worst worst;
    for (std::size_t k = 0; k < velocity_.size(); ++k) {
      const double value = value_at(k), use = utilisation_of(limit_.kind, value, bound());
      if (use > worst.use) worst = {use, value};
    }
    return worst;
  }
  /// Whether the value of a sample is the worst but for rounding.
  bool is_worst(std::int64_t k, const Worst& worst) const {
    if (worst.use == 0.0) return k == 0;
    if (k < 0 || k >= static_cast<std::int64_t>(velocity_.size())) return false;
    return std::abs(utilisation_of(limit_.kind, value_at(static_cast<std::size_t>(k)), bound()) - worst.use) <=
           rounding;
  }

 private:
  const std::vector<double>& velocity_;
  const Axis& axis_;
  const AxisLimit& limit_;
  double period_;
};

class Check {
 public:
  Check(const ProgramResult& result, const Task& task) : result_(result), task_(task) {}

  ProgramResultCheck run() {
    const Toolpath& path = result_.path;
    const DirectMotion motion = direct_motion(path, result_.sample_period, result_.plan.delays, result_.legs);
    const double time = static_cast<double>(motion.samples) * result_.sample_period;
    check_filter();
    check_joints(motion);
    check_limits(motion);
    check_vibration();
    describe(motion, time);
    report_.accepted = report_.reasons.empty();
    report_.shown = fmt::format("{} samples of {} commanded blocks simulated anew, {:.6g} s: all bounds hold",
                                motion.samples, path.blocks(), time);
    return std::move(report_);
  }

 private:
  void wrong(std::string reason) {
    if (report_.reasons.size() < 20) report_.reasons.push_back(std::move(reason));
  }

  void check_filter() {
    if (!task_.filter) return;
    const Filter given = make_filter(*task_.filter);
    const auto own = result_.filter.taps(), asked = given.taps();
    const bool same = std::equal(own.begin(), own.end(), asked.begin(), asked.end(),
                                 [](double a, double b) { return std::abs(a - b) <= 1e-12; });
    if (!same) wrong("the taps are not those of the task's filter");
  }

  void check_joints(const DirectMotion& motion) {
    const Toolpath& path = result_.path;
    for (std::size_t b = 0; b + 1 < path.blocks(); ++b) {
      const double found = direct_error(motion, path, b), recorded = result_.plan.errors[b];
      if (!close(recorded, found, position_rounding))
        wrong(fmt::format("line {}: corner error is recorded as {:.9g} m, found {:.9g} m", path.line[b], recorded,
                          found));
      if (found > path.tolerance[b] * (1.0 + rounding) + position_rounding)
        wrong(fmt::format("line {}: corner error {:.9g} m exceeds its tolerance {:.9g} m", path.line[b], found,
                          path.tolerance[b]));
    }
  }

  /// The limits of axes stand first, in the order of the axes and of the table of limits.
  void check_limits(const DirectMotion& motion) {
    const Machine machine = program_machine(task_.machine, result_.path);
    std::size_t i = 0;
    for (std::size_t a = 0; a < machine.axes.size(); ++a) {
      for (const AxisLimit& limit : axis_limits) {
        const UseOfLimit use(motion, machine.axes[a], a, limit, result_.sample_period);
        if (use.bound() < unlimited) check_limit(i++, use, limit.kind, machine.axes[a].name);
      }
    }
    limits_ = i;
  }

  void check_limit(std::size_t i, const UseOfLimit& use, LimitKind kind, const std::string& axis) {
    const std::string name = fmt::format("{} {}", to_string(kind), axis);
    const Worst found = use.worst();
    if (found.use > 1.0 + rounding) wrong(fmt::format("{} is broken: {:.6g} %", name, 100.0 * found.use));
    const auto& limits = result_.plan.simulation.limits;
    if (i >= limits.size() || limits[i].kind != kind || limits[i].axis != axis)
      return wrong(fmt::format("limits[{}] should be {}", i, name));
    const LimitUse& recorded = limits[i];
    if (recorded.bound != use.bound())
      wrong(fmt::format("{}: bound is recorded as {:.9g}, the task's is {:.9g}", name, recorded.bound, use.bound()));
    if (!close(recorded.value, found.value, rounding * use.bound()))
      wrong(fmt::format("{}: value is recorded as {:.9g}, found {:.9g}", name, recorded.value, found.value));
    if (!close(recorded.utilisation, found.use, rounding))
      wrong(fmt::format("{}: utilisation is recorded as {:.9g}, found {:.9g}", name, recorded.utilisation, found.use));
    if (!use.is_worst(recorded.sample, found))
      wrong(fmt::format("{}: is not used most at sample {}", name, recorded.sample));
    check_line(i, name);
  }

  /// Lines come from the simulation of the plan. Of samples that use a limit alike it may choose another one elsewhere.
  void check_line(std::size_t i, const std::string& name) {
    const Simulation& recorded = result_.plan.simulation;
    if (lines_.limits.empty()) lines_ = simulated();
    const bool same_sample = lines_.limits[i].sample == recorded.limits[i].sample;
    const auto& lines = result_.path.line;
    const bool right = same_sample ? lines_.limit_lines[i] == recorded.limit_lines[i]
                                   : std::find(lines.begin(), lines.end(), recorded.limit_lines[i]) != lines.end();
    if (!right)
      wrong(fmt::format("{}: line is recorded as {}, found {}", name, recorded.limit_lines[i], lines_.limit_lines[i]));
  }

  Simulation simulated() const {
    const Machine machine = program_machine(task_.machine, result_.path);
    std::vector<double> errors(result_.path.blocks());
    SimulationOptions options;
    options.machine = &machine;
    return simulate_program(CommandTiming(result_.path, result_.sample_period, result_.plan.delays), result_.legs, 0,
                            result_.path.blocks() - 1, errors, options);
  }

  void check_vibration() {
    for (const Filter& filter : result_.legs.filters()) {
      for (const LimitUse& use : vibration_utilisation(filter, result_.sample_period, task_.machine)) {
        if (use.utilisation > 1.0 + verification_tolerance)
          wrong(fmt::format("vibration at {:.6g} Hz: {:.6g} % of its bound", use.frequency, 100.0 * use.utilisation));
      }
    }
  }

  /// What follows from the commands, and from errors and uses of limits, which were compared above.
  void describe(const DirectMotion& motion, double time) {
    ProgramResult& found = report_.found;
    found.program = result_.program;
    found.filter = result_.filter;
    found.legs = result_.legs;
    found.sample_period = result_.sample_period;
    found.path = result_.path;
    found.plan.delays = result_.plan.delays;
    found.plan.errors = result_.plan.errors;
    found.plan.errors_hold = true;  // or there is a reason
    found.plan.simulation = result_.plan.simulation;
    found.plan.simulation.samples = motion.samples;
    found.plan.simulation.limits.resize(std::min(limits_, found.plan.simulation.limits.size()));
    found.plan.simulation.limit_lines.resize(found.plan.simulation.limits.size());
    found.cycle_time = time;
    judge_program(found, program_machine(task_.machine, result_.path));
  }

  const ProgramResult& result_;
  const Task& task_;
  ProgramResultCheck report_;
  std::size_t limits_ = 0;  // of axes
  Simulation lines_;        // made when first asked for
};

}  // namespace

ProgramResultCheck verify_program_result(const ProgramResult& result, const Task& task) {
  return Check(result, task).run();
}

}  // namespace accdec
