#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>

#include <accdec/machine/limits.hpp>
#include <accdec/program/simulate/direct.hpp>
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

struct Worst {
  double use = 0.0, value = 0.0;
};

/// Worst use of every limit of an axis over the whole motion.
std::map<LimitKind, Worst> worst_uses(const DirectMotion& motion, const Axis& axis, std::size_t a, double period) {
  std::map<LimitKind, Worst> worst;
  double speed = 0.0, acceleration = 0.0;
  for (const double v : motion.velocity[a]) {
    const double next = (v - speed) / period, jerk = (next - acceleration) / period;
    const AxisState state = axis_state(axis, v, next, jerk);
    speed = v, acceleration = next;
    for (const AxisLimit& limit : axis_limits) {
      if (!(axis.*limit.bound < unlimited)) continue;
      const double value = limit.value(state), use = utilisation_of(limit.kind, value, axis.*limit.bound);
      Worst& w = worst[limit.kind];
      if (use > w.use) w = {use, value};
    }
  }
  return worst;
}

class Check {
 public:
  Check(const ProgramResult& result, const Task& task) : result_(result), task_(task) {}

  ProgramResultCheck run() {
    const Toolpath& path = result_.path;
    const DirectMotion motion = direct_motion(path, result_.sample_period, result_.plan.delays, result_.legs);
    if (motion.samples != result_.plan.simulation.samples)
      wrong(fmt::format("samples are recorded as {}, found {}", result_.plan.simulation.samples, motion.samples));
    const double time = static_cast<double>(motion.samples) * result_.sample_period;
    if (!close(result_.cycle_time, time, 0.0))
      wrong(fmt::format("cycle_time_s is recorded as {:.12g}, found {:.12g}", result_.cycle_time, time));
    check_joints(motion);
    check_limits(motion);
    check_vibration();
    report_.accepted = report_.reasons.empty();
    report_.shown = fmt::format("{} samples of {} commanded blocks simulated anew, {:.6g} s: all bounds hold",
                                motion.samples, path.blocks(), time);
    return std::move(report_);
  }

 private:
  void wrong(std::string reason) {
    if (report_.reasons.size() < 20) report_.reasons.push_back(std::move(reason));
  }

  void check_joints(const DirectMotion& motion) {
    const Toolpath& path = result_.path;
    double worst = 0.0;
    for (std::size_t b = 0; b + 1 < path.blocks(); ++b) {
      if (!(path.tolerance[b] < unlimited)) continue;
      const double found = direct_error(motion, path, b), recorded = result_.plan.errors[b];
      if (!close(recorded, found, position_rounding))
        wrong(fmt::format("line {}: corner error is recorded as {:.9g} m, found {:.9g} m", path.line[b], recorded,
                          found));
      if (found > path.tolerance[b] * (1.0 + rounding) + position_rounding)
        wrong(fmt::format("line {}: corner error {:.9g} m exceeds its tolerance {:.9g} m", path.line[b], found,
                          path.tolerance[b]));
      const bool turns = path.joint[b] != Joint::straight || result_.plan.delays[b] > 0;
      if (turns) worst = std::max(worst, found);
    }
    if (!close(result_.worst_error, worst, position_rounding))
      wrong(fmt::format("worst_error_m is recorded as {:.9g}, found {:.9g}", result_.worst_error, worst));
  }

  void check_limits(const DirectMotion& motion) {
    const Machine machine = program_machine(task_.machine, result_.path);
    std::size_t expected = 0;
    for (std::size_t a = 0; a < machine.axes.size(); ++a) {
      for (const auto& [kind, found] : worst_uses(motion, machine.axes[a], a, result_.sample_period)) {
        ++expected;
        const std::string name = fmt::format("{} {}", to_string(kind), machine.axes[a].name);
        if (found.use > 1.0 + rounding) wrong(fmt::format("{} is broken: {:.6g} %", name, 100.0 * found.use));
        const LimitUse* recorded = nullptr;
        for (const LimitUse& use : result_.plan.simulation.limits) {
          if (use.kind == kind && use.axis == machine.axes[a].name) recorded = &use;
        }
        if (recorded == nullptr)
          wrong(name + " is a limit of the task, but not recorded");
        else if (!close(recorded->utilisation, found.use, 1e-9))
          wrong(fmt::format("{}: utilisation is recorded as {:.9g}, found {:.9g}", name, recorded->utilisation,
                            found.use));
      }
    }
    const auto of_axes = static_cast<std::size_t>(
        std::count_if(result_.plan.simulation.limits.begin(), result_.plan.simulation.limits.end(),
                      [](const LimitUse& use) { return use.kind != LimitKind::vibration; }));
    if (of_axes != expected) wrong(fmt::format("{} limits of axes are recorded, the task has {}", of_axes, expected));
  }

  void check_vibration() {
    for (const Filter& filter : result_.legs.filters()) {
      for (const LimitUse& use : vibration_utilisation(filter, result_.sample_period, task_.machine)) {
        if (use.utilisation > 1.0 + verification_tolerance)
          wrong(fmt::format("vibration at {:.6g} Hz: {:.6g} % of its bound", use.frequency, 100.0 * use.utilisation));
      }
    }
  }

  const ProgramResult& result_;
  const Task& task_;
  ProgramResultCheck report_;
};

double distance(const double* a, const double* b, std::size_t n) {
  double sum = 0.0;
  for (std::size_t i = 0; i < n; ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum);
}

/// How far along the way from a to b the point is nearest, as a part of it, and its distance from there, m.
std::pair<double, double> foot_on(const double* a, const double* b, const double* point, std::size_t n) {
  double along = 0.0, whole = 0.0, off = 0.0;
  for (std::size_t i = 0; i < n; ++i)
    along += (point[i] - a[i]) * (b[i] - a[i]), whole += (b[i] - a[i]) * (b[i] - a[i]);
  const double part = along / whole;
  for (std::size_t i = 0; i < n; ++i) {
    const double d = point[i] - a[i] - part * (b[i] - a[i]);
    off += d * d;
  }
  return {part, std::sqrt(off)};
}

/// Dwells by block, s.
std::map<std::size_t, double> dwells(const Toolpath& path) {
  std::map<std::size_t, double> sum;
  for (const auto& [block, time] : path.dwell) sum[block] += time;
  return sum;
}

}  // namespace

ProgramResultCheck verify_program_result(const ProgramResult& result, const Task& task) {
  return Check(result, task).run();
}

std::string departs_from(const Toolpath& commanded, const Toolpath& programmed) {
  if (commanded.axes != programmed.axes) return "other axes move than in the program";
  const std::size_t n = programmed.dimensions();
  if (distance(commanded.asked(0), programmed.point(0), n) > position_rounding) return "it begins elsewhere";
  if (commanded.dwell_first < programmed.dwell_first) return "the dwell before the first block is shorter";
  const auto own = dwells(commanded), asked = dwells(programmed);
  std::size_t c = 0;
  for (std::size_t b = 0; b < programmed.blocks(); ++b) {
    const double *from = programmed.point(b), *to = programmed.point(b + 1);
    const double length = distance(from, to, n), speed = length / programmed.duration[b];
    const auto at_line = [&](const char* what) { return fmt::format("line {}: {}", programmed.line[b], what); };
    double passed = 0.0;  // part of the block
    for (;; ++c) {
      if (c == commanded.blocks()) return at_line("the commands end before it does");
      const double* end = commanded.asked(c + 1);
      const auto [part, off] = foot_on(from, to, end, n);
      if (off > position_rounding || part < passed - position_rounding / length ||
          part > 1.0 + position_rounding / length)
        return at_line("the path leaves it");
      passed = part;
      const double piece = distance(commanded.asked(c), end, n);
      if (piece > speed * commanded.duration[c] * (1.0 + 1e-5) + position_rounding)
        return at_line("is commanded above its programmed feed");
      if (distance(end, to, n) <= position_rounding) break;
    }
    const Joint joint = commanded.joint[c];
    if (b + 1 < programmed.blocks()) {
      if (programmed.joint[b] == Joint::stop && joint != Joint::stop)
        return at_line("the program stops, the commands do not");
      if (commanded.tolerance[c] > programmed.tolerance[b] * (1.0 + 1e-9))
        return at_line("the tolerance is wider than the program's");
    }
    const auto dwell = asked.find(b);
    if (dwell != asked.end()) {
      const auto kept = own.find(c);
      if (kept == own.end() || kept->second < dwell->second * (1.0 - 1e-9)) return at_line("its dwell is not kept");
    }
    ++c;
  }
  return c == commanded.blocks() ? "" : "the commands go on after the program's end";
}

}  // namespace accdec
