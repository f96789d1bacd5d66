#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include <accdec/design/limit_rows.hpp>
#include <accdec/machine.hpp>
#include <accdec/machine/limits.hpp>
#include <accdec/machine/response.hpp>

namespace accdec {

Affine CumulativeVariables::cumulative(int k) const {
  if (k <= 0) return {};
  if (k > order_) return {1.0, {}};
  return {0.0, {{k - 1, 1.0}}};
}

Affine CumulativeVariables::remaining(int k) const {
  return Affine{1.0, {}} + -1.0 * cumulative(k);
}

Affine CumulativeVariables::tap(int i) const {
  return i < 0 || i > order_ ? Affine{} : cumulative(i + 1) + -1.0 * cumulative(i);
}

Affine CumulativeVariables::remaining_moment(int k) const {
  Affine sum{static_cast<double>(std::max(0, -k)), {}};
  for (int j = std::max(k, 0) + 1; j <= order_; ++j) {
    sum.constant += 1.0;
    sum.add(j - 1, -1.0);
  }
  return sum;
}

Affine CumulativeVariables::elapsed_moment(int m) const {
  Affine sum{static_cast<double>(std::max(0, m - order_)), {}};
  for (int j = 1; j <= std::min(m, order_); ++j) sum.add(j - 1, 1.0);
  return sum;
}

CumulativeVariables add_cumulative_variables(QuadraticProblem& problem, int order) {
  for (int k = 1; k <= order; ++k) problem.add_variable(fmt::format("B_{}", k), {0.0, 1.0});
  return CumulativeVariables(order);
}

namespace {

/// Largest speeds at which one axis starts and stops alone in any event of the task. Start and stop rows grow with the
/// speed, so the largest implies the rest.
struct AxisSpeeds {
  double start = 0.0, stop = 0.0;
};

AxisSpeeds axis_speeds(const Task& task, Eigen::Index axis) {
  AxisSpeeds speeds;
  for (const TaskCorner& corner : task.corners) {
    const double in = std::abs(corner.geometry().feed_in * corner.geometry().direction_in[axis]);
    const double out = std::abs(corner.geometry().feed_out * corner.geometry().direction_out[axis]);
    // An axis moved by one leg only sees a plain stop or start in the blend as well.
    speeds.start = std::max({speeds.start, in, in == 0.0 ? out : 0.0});
    speeds.stop = std::max({speeds.stop, out, out == 0.0 ? in : 0.0});
  }
  return speeds;
}

class RowBuilder {
 public:
  RowBuilder(QuadraticProblem& problem, const CumulativeVariables& b, const Task& task,
             const FormulationOptions& options)
      : problem_(problem),
        b_(b),
        task_(task),
        options_(options),
        period_(task.sample_period),
        one_(1.0 - options.margin) {}

  void taps() {
    double bound = 1.0;
    for (std::size_t a = 0; a < task_.machine.axes.size(); ++a) {
      const AxisSpeeds speeds = axis_speeds(task_, index(a));
      const double fastest = std::max(speeds.start, speeds.stop);
      const double limit = task_.machine.axes[a].acceleration_max;
      if (fastest > 0.0 && limit < unlimited) bound = std::min(bound, limit * period_ / fastest);
    }
    const double upper = bound < 1.0 ? bound * one_ : nlp::infinity;
    for (int i = 0; i <= b_.order(); ++i) affine(fmt::format("acceleration, tap {}", i), b_.tap(i), {0.0, upper});
  }

  /// A limit on the n-th difference of the acceleration, at start and stop of the fastest leg.
  void ramp(const AxisLimit& limit, int n) {
    double bound = nlp::infinity;  // on the n-th difference of the taps
    std::string name;
    for (std::size_t a = 0; a < task_.machine.axes.size(); ++a) {
      const AxisSpeeds speeds = axis_speeds(task_, index(a));
      const double fastest = std::max(speeds.start, speeds.stop);
      const double allowed = task_.machine.axes[a].*limit.bound * std::pow(period_, n + 1) / fastest;
      if (fastest > 0.0 && allowed < bound) {
        bound = allowed;
        name = task_.machine.axes[a].name;
      }
    }
    if (bound >= std::ldexp(1.0, n - 1)) return;  // larger than any taps from 0 to 1 can give
    for (int i = 0; i <= b_.order() + n; ++i) {
      affine(fmt::format("{} {}, k = {}", to_string(limit.kind), name, i + 1),
             (1.0 / bound) * difference(n, [&](int j) { return b_.tap(i - j); }), {-one_, one_});
    }
  }

  /// Start and stop of one axis at the task's largest speeds.
  void start_and_stop(std::size_t a) {
    const Axis& axis = task_.machine.axes[a];
    const AxisSpeeds speeds = axis_speeds(task_, index(a));
    for (int k = 1; k <= b_.order() + 1; ++k) {
      if (speeds.start > 0.0) {
        const double s = speeds.start;
        const Affine force = s * (axis.mass / period_ * b_.tap(k - 1) + axis.damping * b_.cumulative(k)) + dry(axis);
        bounded(axis, "start", k, LimitKind::force, force);
        bounded(axis, "start", k, LimitKind::power, force, s * b_.cumulative(k));
        along_curve(axis, "start", k, force, s * b_.cumulative(k), 1.0);
      }
      if (speeds.stop > 0.0) {
        const double s = speeds.stop;
        const Affine force = s * (-axis.mass / period_ * b_.tap(k - 1) + axis.damping * b_.remaining(k)) + dry(axis);
        // Driving forces while stopping stay below friction at feed, which is no row. Braking forces at or below the
        // start's speed stay below the forces of the start.
        if (speeds.stop > speeds.start) bounded(axis, "stop", k, LimitKind::force, force);
        along_curve(axis, "stop", k, -1.0 * force, s * b_.remaining(k), 1.0);
        if (k <= b_.order()) bounded(axis, "stop", k, LimitKind::regeneration, force, s * b_.remaining(k));
      }
    }
  }

  /// Blend of one corner on an axis that both legs move.
  void blend(std::size_t a, const TaskCorner& corner, int delay) {
    const Axis& axis = task_.machine.axes[a];
    const double in = corner.geometry().feed_in * corner.geometry().direction_in[index(a)];
    const double out = corner.geometry().feed_out * corner.geometry().direction_out[index(a)];
    if (in == 0.0 || out == 0.0) return;
    const std::string event = "blend of corner " + corner.name;
    const int n = b_.order();
    const auto acceleration = [&](int k) {
      return -in / period_ * b_.tap(k - 1) + out / period_ * b_.tap(k - 1 - delay);
    };
    for (int k = 1; k <= n + delay + 1; ++k) {
      const Affine v = in * b_.remaining(k) + out * b_.cumulative(k - delay);
      const Affine acc = acceleration(k);
      const bool overlap = k - 1 <= n && k - 1 - delay >= 0;
      // Accelerations of equal sign partly cancel and stay below the larger; only opposed legs add up.
      if (overlap && in * out < 0.0) bounded(axis, event, k, LimitKind::acceleration, acc);
      const Affine moving = axis.mass * acc + axis.damping * v;
      // The sample at which an axis reverses is not known. So its dry friction counts against the limit on either side.
      const bool reverses = axis.coulomb > 0.0 && in * out < 0.0;
      for (const double sign : {1.0, -1.0}) {
        if (!reverses && sign * in < 0.0) continue;
        const Affine force = moving + sign * dry(axis);
        bounded(axis, event, k, LimitKind::force, force);
        bounded(axis, event, k, LimitKind::power, force, v);
        if (!reverses) bounded(axis, event, k, LimitKind::regeneration, force, v);
      }
      if (reverses) bounded(axis, event, k, LimitKind::regeneration, moving, v);
      for (const double direction : {1.0, -1.0}) {
        if (in * out > 0.0 && direction * in < 0.0) continue;
        for (const double side : {1.0, -1.0})
          along_curve(axis, event, k, side * (moving + direction * dry(axis)), v, direction);
      }
    }
    for (const AxisLimit& limit : axis_limits) {
      const int times = limit.differences;
      if (times < 1 || axis.*limit.bound == unlimited) continue;
      for (int k = delay + 1; k <= n + 1 + times; ++k) {
        bounded(axis, event, k, limit.kind,
                std::pow(period_, -times) * difference(times, [&](int j) { return acceleration(k - j); }));
      }
    }
  }

  /// The supply that all axes share, while a corner's leg 1 starts, its legs meet, and leg 2 stops.
  void supply(const TaskCorner& corner, int delay) {
    if (!limits_supply(task_.machine)) return;
    const std::string at = ", corner " + corner.name;
    for (int k = 1; k <= b_.order() + 1; ++k) {
      supply_rows("start" + at, k, corner, {}, b_.cumulative(k), {}, b_.tap(k - 1), true);
      supply_rows("stop" + at, k, corner, {}, b_.remaining(k), {}, -1.0 * b_.tap(k - 1), false);
    }
    for (int k = 1; k <= b_.order() + delay + 1; ++k)
      supply_rows("blend" + at, k, corner, b_.remaining(k), b_.cumulative(k - delay), -1.0 * b_.tap(k - 1),
                  b_.tap(k - 1 - delay), false);
  }

  void speed(const TaskCorner& corner, int delay) {
    if (corner.speed_min <= 0.0) return;
    const double v1 = corner.geometry().feed_in / corner.speed_min, v2 = corner.geometry().feed_out / corner.speed_min;
    const double c = corner.geometry().cos_interior();
    const double least = (1.0 + options_.margin) * (1.0 + options_.margin);
    for (int k = 1; k <= b_.order() + delay + 1; ++k) {
      const Affine in = b_.remaining(k), out = b_.cumulative(k - delay);
      const int row =
          problem_.add_row(fmt::format("smallest speed, corner {}, k = {}", corner.name, k), {least, nlp::infinity});
      problem_.add_product(row, v1 * v1, in, in);
      problem_.add_product(row, v2 * v2, out, out);
      problem_.add_product(row, -2.0 * v1 * v2 * c, in, out);
    }
  }

  /// The path is near leg 1 before the time, near leg 2 after it.
  void contour(const TaskCorner& corner, int delay, double time) {
    if (!corner.contour_max || !(*corner.contour_max > 0.0)) return;  // a bound of zero is an exact stop
    const int k = static_cast<int>(time);
    const double scale = period_ * std::sin(std::acos(corner.geometry().cos_interior())) / *corner.contour_max;
    const auto row = [&](double feed, const Affine& now, const Affine& next) {
      const Affine gone = scale * feed * ((1.0 - time + k) * now + (time - k) * next);
      affine("contour of corner " + corner.name, gone, {-nlp::infinity, one_});
    };
    row(corner.geometry().feed_out, b_.elapsed_moment(k - delay), b_.elapsed_moment(k + 1 - delay));
    row(corner.geometry().feed_in, b_.remaining_moment(k), b_.remaining_moment(k + 1));
  }

  void vibration(const Mode& mode, const std::vector<double>& frequencies) {
    if (mode.residual_max >= 1.0 && !mode.of_axis()) return;
    const double fastest = mode.of_axis() ? fastest_leg(task_, mode.axis) : 0.0;
    // A mode of an axis is bounded at starts and stops. Blends depend on the delay; verification judges them.
    const auto bound = [&](double f, double damping) {
      const double damped = 2.0 * std::numbers::pi * f * std::sqrt(1.0 - damping * damping);
      return mode.of_axis() ? mode.displacement_max * damped / fastest : mode.residual_max;
    };
    for (const double f : frequencies) {
      for (const double damping : {mode.damping_low, mode.damping_high}) {
        if (bound(f, damping) < 1.0) vibration(bound(f, damping), f, damping);
        if (mode.damping_high == mode.damping_low) break;
      }
    }
  }

  void vibration(double bound, double frequency, double damping) {
    const double natural = 2.0 * std::numbers::pi * frequency * period_;
    const double w = natural * std::sqrt(1.0 - damping * damping);
    Affine real, imaginary;
    for (int i = 0; i <= b_.order(); ++i) {
      const double left = std::exp(-damping * natural * (b_.order() - i));
      real += left * std::cos(w * i) * b_.tap(i);
      imaginary += left * std::sin(w * i) * b_.tap(i);
    }
    std::string name = fmt::format("vibration at {:.6g} Hz", frequency);
    if (damping > 0.0) name += fmt::format(", damping {:.6g}", damping);
    if (bound == 0.0) {
      affine(name + ", cosine", real, {0.0, 0.0});
      affine(name + ", sine", imaginary, {0.0, 0.0});
      return;
    }
    if (!options_.reduced) {
      real = defined_variable("C at " + name, real);
      imaginary = defined_variable("S at " + name, imaginary);
    }
    const int row = problem_.add_row(name, {-nlp::infinity, one_ * one_});
    for (const Affine& part : {real, imaginary}) problem_.add_product(row, 1.0 / (bound * bound), part, part);
  }

  void symmetry() {
    for (int k = 1; 2 * k <= b_.order() + 1; ++k) {
      affine(fmt::format("symmetry, k = {}", k), b_.cumulative(k) + b_.cumulative(b_.order() + 1 - k), {1.0, 1.0});
    }
  }

 private:
  static Eigen::Index index(std::size_t a) { return static_cast<Eigen::Index>(a); }
  static Affine dry(const Axis& axis) { return {axis.coulomb, {}}; }

  /// Rows of the total power at one sample. @param in, out  parts of both legs' velocities
  /// @param gains_in, gains_out  their changes since the sample before  @param first  `out` is of leg 1: its start
  void supply_rows(const std::string& event, int k, const TaskCorner& corner, const Affine& in, const Affine& out,
                   const Affine& gains_in, const Affine& gains_out, bool first) {
    const Machine& machine = task_.machine;
    const Corner& g = corner.geometry();
    const auto add = [&](LimitKind kind, double bound, double sign) {
      if (bound == unlimited) return;
      const int row =
          problem_.add_row(fmt::format("{}, {}, k = {}", to_string(kind), event, k), {-nlp::infinity, one_});
      for (std::size_t a = 0; a < machine.axes.size(); ++a) {
        const Axis& axis = machine.axes[a];
        const double v1 = g.feed_in * g.direction_in[index(a)], v2 = g.feed_out * g.direction_out[index(a)];
        const double last = first ? v1 : v2;
        const Affine v = v1 * in + last * out;
        if (v.terms.empty() && v.constant == 0.0) continue;
        const Affine moving = axis.mass / period_ * (v1 * gains_in + last * gains_out) + axis.damping * v;
        problem_.add_product(row, sign / bound, moving, v);
        // Friction takes its force times |V|. If an axis reverses, the speeds of both legs together are no less.
        const bool reverses = v1 * v2 < 0.0 && !in.terms.empty();
        if (axis.coulomb > 0.0 && !(reverses && sign < 0.0))
          problem_.add_to_row(row, sign * axis.coulomb / bound * (std::abs(v1) * in + std::abs(last) * out));
      }
    };
    add(LimitKind::power_total, machine.power_total_max, 1.0);
    add(LimitKind::regeneration_total, machine.regeneration_total_max, -1.0);
  }

  /// The n-th difference of a sequence. @param ago  its value j samples ago
  template <class Sequence>
  static Affine difference(int n, const Sequence& ago) {
    Affine sum = ago(0);
    for (int j = 1; j <= n; ++j) sum += difference_weight(n, j) * ago(j);
    return sum;
  }

  void affine(std::string name, const Affine& value, nlp::Bound bound) {
    problem_.add_to_row(problem_.add_row(std::move(name), bound), value);
  }

  /// A new variable equal to an affine form, so that dense forms appear only in linear rows.
  Affine defined_variable(const std::string& name, const Affine& value) {
    const int variable = problem_.add_variable(name, {-nlp::infinity, nlp::infinity});
    affine("definition of " + name, value + Affine{0.0, {{variable, -1.0}}}, {0.0, 0.0});
    return {0.0, {{variable, 1.0}}};
  }

  /// Row for one limit of one axis at one sample, scaled to +-1. None if the axis has no such limit. `quantity` is the
  /// bounded value, or the force of a power at the given speed.
  void bounded(const Axis& axis, const std::string& event, int k, LimitKind kind, const Affine& quantity,
               const Affine& speed = {1.0, {}}) {
    const auto add = [&](double bound, nlp::Bound scaled) {
      if (bound == unlimited) return;
      std::string name = fmt::format("{} {}, {}, k = {}", to_string(kind), axis.name, event, k);
      if (speed.terms.empty()) {
        affine(std::move(name), speed.constant / bound * quantity, scaled);
      } else {
        problem_.add_product(problem_.add_row(std::move(name), scaled), 1.0 / bound, quantity, speed);
      }
    };
    const bool low = kind != LimitKind::power, high = kind != LimitKind::regeneration;  // sides that are bounded
    add(axis.*axis_limit(kind).bound, {low ? -one_ : -nlp::infinity, high ? one_ : nlp::infinity});
  }

  /// Rows of the lines of a force-speed curve. @param direction  sign of the speed that counts
  void along_curve(const Axis& axis, const std::string& event, int k, const Affine& force, const Affine& speed,
                   double direction) {
    for (const ForceLine& line : force_lines(axis))
      affine(fmt::format("force_speed {}, {}, k = {}, slope {:.6g}", axis.name, event, k, line.slope),
             (1.0 / line.force) * (force + direction * line.slope * speed), {-nlp::infinity, one_});
  }

  QuadraticProblem& problem_;
  const CumulativeVariables& b_;
  const Task& task_;
  const FormulationOptions& options_;
  double period_, one_;
};

}  // namespace

double fastest_leg(const Task& task, int axis) {
  const AxisSpeeds speeds = axis_speeds(task, axis);
  return std::max(speeds.start, speeds.stop);
}

void add_blend_rows(QuadraticProblem& problem, const CumulativeVariables& b, const Task& task,
                    const FormulationOptions& options, std::size_t corner) {
  RowBuilder rows(problem, b, task, options);
  for (std::size_t a = 0; a < task.machine.axes.size(); ++a)
    rows.blend(a, task.corners[corner], options.blend_delays[corner]);
  rows.supply(task.corners[corner], options.blend_delays[corner]);
  rows.speed(task.corners[corner], options.blend_delays[corner]);
  if (!options.contour_times.empty())
    rows.contour(task.corners[corner], options.blend_delays[corner], options.contour_times[corner]);
}

void add_common_rows(QuadraticProblem& problem, const CumulativeVariables& b, const Task& task,
                     const FormulationOptions& options) {
  require_no_response(task.machine, "a nonlinear problem");
  RowBuilder rows(problem, b, task, options);
  rows.taps();
  for (const AxisLimit& limit : axis_limits) {
    if (limit.differences > 0) rows.ramp(limit, limit.differences);
  }
  for (std::size_t a = 0; a < task.machine.axes.size(); ++a) rows.start_and_stop(a);
  for (std::size_t i = 0; i < task.machine.modes.size(); ++i) {
    rows.vibration(task.machine.modes[i], options.mode_frequencies[i]);
  }
  if (task.design.symmetric) rows.symmetry();
}

void add_limit_rows(QuadraticProblem& problem, const CumulativeVariables& b, const Task& task,
                    const FormulationOptions& options) {
  add_common_rows(problem, b, task, options);
  for (std::size_t j = 0; j < task.corners.size(); ++j) add_blend_rows(problem, b, task, options, j);
}

std::vector<std::vector<double>> initial_frequencies(const Task& task, int order) {
  std::vector<std::vector<double>> all;
  for (const Mode& mode : task.machine.modes) {
    const double width = mode.frequency_high - mode.frequency_low;
    const int cells = width > 0.0 ? 1 + static_cast<int>(2.0 * width * task.sample_period * (order + 1)) : 0;
    std::vector<double> frequencies{mode.frequency_low};
    for (int i = 1; i <= cells; ++i) frequencies.push_back(mode.frequency_low + width * i / cells);
    all.push_back(std::move(frequencies));
  }
  return all;
}

}  // namespace accdec
