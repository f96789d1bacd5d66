#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include <fmt/format.h>

#include <accdec/design/row_builder.hpp>
#include <accdec/machine.hpp>
#include <accdec/machine/limits.hpp>
#include <accdec/machine/response.hpp>

namespace accdec {

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

}  // namespace

RowBuilder::RowBuilder(QuadraticProblem& problem, const CumulativeVariables& b, const Task& task,
                       const FormulationOptions& options)
    : problem_(problem),
      b_(b),
      task_(task),
      options_(options),
      period_(task.sample_period),
      one_(1.0 - options.margin),
      response_(task.machine, period_),
      tap_max_(tap_max()),
      command_(b.behind(response_.prefilter())) {
  for (std::size_t a = 0; a < task.machine.axes.size(); ++a) motions_.push_back(b.behind(motion_taps(response_, a)));
}

double RowBuilder::tap_max() const {
  double bound = 1.0;
  for (std::size_t a = 0; a < task_.machine.axes.size(); ++a) {
    const AxisSpeeds speeds = axis_speeds(task_, index(a));
    const double fastest = std::max(speeds.start, speeds.stop);
    const double limit = task_.machine.axes[a].acceleration_max;
    if (fastest > 0.0 && limit < unlimited) bound = std::min(bound, limit * period_ / fastest);
  }
  return bound;
}

void RowBuilder::taps() {
  const double upper = tap_max_ < 1.0 ? tap_max_ * one_ : nlp::infinity;
  const bool smoothed = response_.prefilter_order() > 0;
  for (int i = 0; i <= b_.order(); ++i)
    affine(fmt::format("acceleration, tap {}", i), b_.tap(i), {0.0, smoothed ? nlp::infinity : upper});
  for (int i = 0; smoothed && upper < nlp::infinity && i <= command_.order(); ++i)
    affine(fmt::format("acceleration, smoothed tap {}", i), command_.tap(i), {-nlp::infinity, upper});
}

void RowBuilder::ramp(const AxisLimit& limit, int n) {
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
  for (int i = 0; i <= command_.order() + n; ++i) {
    affine(fmt::format("{} {}, k = {}", to_string(limit.kind), name, i + 1),
           (1.0 / bound) * difference(n, [&](int j) { return command_.tap(i - j); }), {-one_, one_});
  }
}

void RowBuilder::start_and_stop(std::size_t a) {
  const Axis& axis = task_.machine.axes[a];
  const AxisSpeeds speeds = axis_speeds(task_, index(a));
  const CumulativeVariables& motion = motions_[a];
  for (int k = 1; k <= motion.order() + 1; ++k) {
    if (speeds.start > 0.0) {
      const double s = speeds.start;
      const Affine force =
          s * (axis.mass / period_ * motion.tap(k - 1) + axis.damping * motion.cumulative(k)) + dry(axis);
      bounded(axis, "start", k, LimitKind::force, force);
      bounded(axis, "start", k, LimitKind::power, force, s * motion.cumulative(k));
      along_curve(axis, "start", k, force, s * motion.cumulative(k), 1.0);
    }
    if (speeds.stop > 0.0) {
      const double s = speeds.stop;
      const Affine force =
          s * (-axis.mass / period_ * motion.tap(k - 1) + axis.damping * motion.remaining(k)) + dry(axis);
      // Driving forces while stopping stay below friction at feed, which is no row. Braking forces at or below the
      // start's speed stay below the forces of the start, unless a servo swings.
      if (speeds.stop > speeds.start || !response_.averages()) bounded(axis, "stop", k, LimitKind::force, force);
      along_curve(axis, "stop", k, -1.0 * force, s * motion.remaining(k), 1.0);
      if (k <= motion.order()) bounded(axis, "stop", k, LimitKind::regeneration, force, s * motion.remaining(k));
    }
  }
}

void RowBuilder::blend(std::size_t a, const TaskCorner& corner, int delay) {
  const Axis& axis = task_.machine.axes[a];
  const double in = corner.geometry().feed_in * corner.geometry().direction_in[index(a)];
  const double out = corner.geometry().feed_out * corner.geometry().direction_out[index(a)];
  if (in == 0.0 || out == 0.0) return;
  const std::string event = "blend of corner " + corner.name;
  const int n = command_.order();
  const CumulativeVariables& motion = motions_[a];
  const auto acceleration = [&](const CumulativeVariables& b, int k) {
    return -in / period_ * b.tap(k - 1) + out / period_ * b.tap(k - 1 - delay);
  };
  for (int k = 1; k <= motion.order() + delay + 1; ++k) {
    const bool overlap = k - 1 <= n && k - 1 - delay >= 0;
    // Accelerations of equal sign partly cancel and stay below the larger; only opposed legs add up.
    if (overlap && in * out < 0.0) bounded(axis, event, k, LimitKind::acceleration, acceleration(command_, k));
    const Affine v = in * motion.remaining(k) + out * motion.cumulative(k - delay);
    const Affine moving = axis.mass * acceleration(motion, k) + axis.damping * v;
    // The sample at which an axis reverses is not known. So its dry friction counts against the limit on either side.
    const bool reverses = axis.coulomb > 0.0 && in * out < 0.0;
    for (const double sign : {1.0, -1.0}) {
      if (!reverses && sign * in < 0.0) continue;
      const Affine force = moving + sign * dry(axis);
      const std::string friction = !reverses ? "" : sign > 0.0 ? ", moving forwards" : ", moving backwards";
      bounded(axis, event + friction, k, LimitKind::force, force);
      bounded(axis, event + friction, k, LimitKind::power, force, v);
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
              std::pow(period_, -times) * difference(times, [&](int j) { return acceleration(command_, k - j); }));
    }
  }
}

void RowBuilder::affine(std::string name, const Affine& value, nlp::Bound bound) {
  problem_.add_to_row(problem_.add_row(std::move(name), bound), value);
}

double RowBuilder::largest(const Affine& form) const {
  if (response_.ideal()) return unlimited;
  problem_.go_on();
  // Behind a control's smoothing, its own taps are bounded, not those of the filter.
  const double most = response_.prefilter_order() > 0 ? 1.0 : tap_max_;
  return std::max(largest_over_taps(form, b_.order(), most), largest_over_taps(-1.0 * form, b_.order(), most));
}

void RowBuilder::product(int row, double coefficient, Affine left, Affine right) {
  // The Hessian of a product of dense forms has as many entries as both have together.
  constexpr std::size_t dense = 8;
  const bool same = left.constant == right.constant && left.terms == right.terms;
  const auto one = [&](Affine& form, const char* side) {
    if (!options_.reduced && form.terms.size() > dense)
      form = defined_variable(fmt::format("{} of a product of {}", side, problem_.row_name(row)), form);
  };
  one(left, "left side");
  if (same)
    right = left;
  else
    one(right, "right side");
  problem_.add_product(row, coefficient, std::move(left), std::move(right));
}

Affine RowBuilder::defined_variable(const std::string& name, const Affine& value) {
  const int variable = problem_.add_variable(name, {-nlp::infinity, nlp::infinity});
  affine("definition of " + name, value + Affine{0.0, {{variable, -1.0}}}, {0.0, 0.0});
  return {0.0, {{variable, 1.0}}};
}

void RowBuilder::bounded(const Axis& axis, const std::string& event, int k, LimitKind kind, const Affine& quantity,
                         const Affine& speed) {
  const auto add = [&](double bound, nlp::Bound scaled) {
    if (bound == unlimited) return;
    if (one_ * bound > largest(quantity) * (speed.terms.empty() ? speed.constant : largest(speed))) return;
    std::string name = fmt::format("{} {}, {}, k = {}", to_string(kind), axis.name, event, k);
    if (speed.terms.empty()) {
      affine(std::move(name), speed.constant / bound * quantity, scaled);
    } else {
      product(problem_.add_row(std::move(name), scaled), 1.0 / bound, quantity, speed);
    }
  };
  const bool low = kind != LimitKind::power, high = kind != LimitKind::regeneration;  // sides that are bounded
  add(axis.*axis_limit(kind).bound, {low ? -one_ : -nlp::infinity, high ? one_ : nlp::infinity});
}

void RowBuilder::along_curve(const Axis& axis, const std::string& event, int k, const Affine& force,
                             const Affine& speed, double direction) {
  for (const ForceLine& line : force_lines(axis))
    affine(fmt::format("force_speed {}, {}, k = {}, slope {:.6g}", axis.name, event, k, line.slope),
           (1.0 / line.force) * (force + direction * line.slope * speed), {-nlp::infinity, one_});
}

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

std::string friction_both_ways(const Task& task) {
  for (std::size_t a = 0; a < task.machine.axes.size(); ++a) {
    const Axis& axis = task.machine.axes[a];
    for (const TaskCorner& corner : task.corners) {
      const auto i = static_cast<Eigen::Index>(a);
      if (axis.coulomb > 0.0 && corner.geometry().direction_in[i] * corner.geometry().direction_out[i] < 0.0)
        return fmt::format(
            "axis {} has dry friction and reverses at corner {}: rows count friction both ways at every sample",
            axis.name, corner.name);
    }
  }
  return "";
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
