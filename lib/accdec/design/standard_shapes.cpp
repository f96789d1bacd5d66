#include <accdec/design/standard_shapes.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include <accdec/design/limit_rows.hpp>
#include <accdec/design/verifier.hpp>
#include <accdec/motion/shapes.hpp>
#include <accdec/motion/smallest_delay.hpp>

namespace accdec {
namespace {

/// Slack for the choice alone: the simulated verification at the end has the last word with its own tolerance.
constexpr double slack = 1.0 + 0.5 * verification_tolerance;

/// Every member of a shape's family at one order.
std::vector<FilterSpec> members(Shape shape, int order) {
  std::vector<FilterSpec> all;
  FilterSpec spec;
  spec.kind = shape;
  spec.order = order;
  switch (shape) {
    case Shape::boxcar: all.push_back(spec); break;
    case Shape::trapezoid:
      for (spec.ramp = 0; spec.ramp <= order / 2; ++spec.ramp) all.push_back(spec);
      break;
    case Shape::s_curve:
    case Shape::hann:
    case Shape::blackman:
      if (order >= 2) all.push_back(spec);
      break;
    case Shape::blackman_sinc:
      for (int j = 1; order >= 2 && j <= blackman_sinc_cutoffs; ++j) {
        spec.cutoff = 2.0 / order * j / blackman_sinc_cutoffs;
        all.push_back(spec);
      }
      break;
    case Shape::taps: throw std::invalid_argument("given taps are no standard shape");
  }
  return all;
}

/// Whether one axis holds its limits on a start to (or, mirrored in time, a stop from) `speed`, m/s: what no delay can change.
bool ramp_holds(const Filter& filter, const Axis& axis, double speed, bool stop, double period) {
  double previous = 0.0;
  for (int k = 0; k <= filter.order() + 2; ++k) {
    const double v = speed * (stop ? filter.remaining(k) : filter.cumulative(k));
    const double acceleration = (stop ? -speed : speed) * filter.tap(k - 1) / period;
    const double force = axis.mass * acceleration + axis.damping * v, power = force * v;
    if (std::abs(acceleration) > axis.acceleration_max * slack) return false;
    if (std::abs(acceleration - previous) / period > axis.jerk_max * slack) return false;
    if (std::abs(force) > axis.force_max * slack || power > axis.power_max * slack) return false;
    if (-power > axis.regeneration_max * slack) return false;
    previous = acceleration;
  }
  return true;
}

bool ramps_hold(const Filter& filter, const Task& task) {
  for (const TaskCorner& corner : task.corners) {
    for (std::size_t a = 0; a < task.machine.axes.size(); ++a) {
      const auto i = static_cast<Eigen::Index>(a);
      const Corner& g = corner.geometry;
      if (!ramp_holds(filter, task.machine.axes[a], g.feed_in * g.direction_in[i], false, task.sample_period)) return false;
      if (!ramp_holds(filter, task.machine.axes[a], g.feed_out * g.direction_out[i], true, task.sample_period)) return false;
    }
  }
  return true;
}

/// The limits of one corner's blend, delay after delay. What failed at one delay most likely fails at the next at about the same sample,
/// so that sample is looked at first and most delays that will not do cost O(axes) instead of O(axes N).
class BlendCheck {
 public:
  BlendCheck(const Filter& filter, const TaskCorner& corner, const Task& task) : filter_(filter), corner_(corner), task_(task) {
    const Corner& g = corner.geometry;
    for (std::size_t a = 0; a < task.machine.axes.size(); ++a) {
      const auto i = static_cast<Eigen::Index>(a);
      legs_.push_back({g.feed_in * g.direction_in[i], g.feed_out * g.direction_out[i]});
    }
  }

  bool holds(int delay) {
    const int last = filter_.order() + delay + 2;
    for (int k : {hint_, hint_ + 1}) {
      if (k <= last && !sample_holds(k, delay)) return false;
    }
    for (int k = 0; k <= last; ++k) {
      if (!sample_holds(k, delay)) {
        hint_ = k;
        return false;
      }
    }
    if (!corner_.error_max) return true;
    const double error = corner_error(Blend(filter_, corner_.geometry, delay, task_.sample_period));
    return error <= position_floor || error <= *corner_.error_max * slack;
  }

 private:
  struct Legs {
    double in, out;  ///< axis components of the two feeds, m/s
  };
  double tap_difference(const Legs& leg, int k, int delay) const {
    return leg.out * filter_.tap(k - 1 - delay) - leg.in * filter_.tap(k - 1);
  }
  bool sample_holds(int k, int delay) const {
    const double period = task_.sample_period, remaining = filter_.remaining(k), gone = filter_.cumulative(k - delay);
    double speed_squared = 0.0;
    for (std::size_t a = 0; a < legs_.size(); ++a) {
      const Axis& axis = task_.machine.axes[a];
      const double v = legs_[a].in * remaining + legs_[a].out * gone;
      const double acceleration = tap_difference(legs_[a], k, delay) / period;
      const double before = k > 0 ? tap_difference(legs_[a], k - 1, delay) / period : 0.0;
      const double force = axis.mass * acceleration + axis.damping * v, power = force * v;
      speed_squared += v * v;
      if (std::abs(v) > axis.velocity_max * slack || std::abs(acceleration) > axis.acceleration_max * slack) return false;
      if (std::abs(acceleration - before) / period > axis.jerk_max * slack || std::abs(force) > axis.force_max * slack) return false;
      if (power > axis.power_max * slack || -power > axis.regeneration_max * slack) return false;
    }
    return corner_.speed_min <= std::sqrt(speed_squared) * slack;
  }

  const Filter& filter_;
  const TaskCorner& corner_;
  const Task& task_;
  std::vector<Legs> legs_;
  int hint_ = 0;
};

/// Delays of one filter with a cycle time below `best` samples, or none.
std::optional<std::vector<int>> delays_below(const Filter& filter, const Task& task, double best) {
  const DelayFinder smallest(filter);
  std::vector<int> delays;
  double cost = 0.0;
  for (const TaskCorner& corner : task.corners) {
    const double step_in = corner.geometry.feed_in * task.sample_period, step_out = corner.geometry.feed_out * task.sample_period;
    const int least = corner.error_max ? smallest(corner.geometry.cos_interior(), step_in, step_out, *corner.error_max) : 0;
    delays.push_back(corner.delay.value_or(least));
    cost += corner.weight * (filter.order() + 1.0 + delays.back());
  }
  // The error bounds alone already say which filters are too slow, long before their limits have to be looked at.
  if (cost >= best || !ramps_hold(filter, task)) return std::nullopt;
  // Most filters that ring too much do so at an end or the middle of a band; only the others need the whole band searched.
  for (const Mode& mode : task.machine.modes) {
    for (const double f : {mode.frequency_low, 0.5 * (mode.frequency_low + mode.frequency_high), mode.frequency_high}) {
      if (residual_vibration(filter, f, task.sample_period) > mode.residual_max * slack) return std::nullopt;
    }
  }
  for (const LimitUse& use : vibration_utilisation(filter, task.sample_period, task.machine)) {
    if (use.utilisation > slack) return std::nullopt;
  }
  for (std::size_t j = 0; j < delays.size(); ++j) {
    const TaskCorner& corner = task.corners[j];
    const int last = corner.delay.value_or(std::max(delays[j], filter.order() + 1));
    BlendCheck check(filter, corner, task);
    while (!check.holds(delays[j])) {
      cost += corner.weight;
      if (++delays[j] > last || cost >= best) return std::nullopt;
    }
  }
  return delays;
}

}  // namespace

StandardShapeResult best_standard_shape(const Task& task, Shape shape) {
  const auto began = std::chrono::steady_clock::now();
  StandardShapeResult answer;
  std::vector<int> best_delays;
  double best = unlimited, weights = 0.0;  // best in samples, not counting the period
  long tried = 0;
  for (const TaskCorner& corner : task.corners) weights += corner.weight;
  double fixed = 0.0;
  for (const TaskCorner& corner : task.corners) fixed += corner.weight * corner.delay.value_or(0);

  std::string message;
  if (const auto impossible = contradictions(task); !impossible.empty()) message = impossible.front();
  for (int order = task.design.order_min; message.empty() && order <= task.design.order_max; ++order) {
    if (weights * (order + 1.0) + fixed >= best) break;
    for (const FilterSpec& spec : members(shape, order)) {
      ++tried;
      const auto delays = delays_below(make_filter(spec), task, best);
      if (!delays) continue;
      best = 0.0;
      for (std::size_t j = 0; j < delays->size(); ++j) best += task.corners[j].weight * (order + 1.0 + (*delays)[j]);
      best_delays = *delays;
      answer.spec = spec;
    }
  }
  Task chosen = task;
  chosen.filter = answer.spec;
  if (answer.spec) {
    answer.result = assess(chosen, make_filter(*answer.spec), best_delays, false);
  } else {
    answer.result.task = task;
    answer.result.status = Status::infeasible;
    answer.result.message = message.empty() ? fmt::format("no {} of order {} to {} holds all limits", to_string(shape),
                                                          task.design.order_min, task.design.order_max)
                                            : message;
  }
  answer.result.solver.method = "given";
  answer.result.solver.name = fmt::format("best {}", to_string(shape));
  answer.result.solver.evaluations = tried;
  answer.result.solver.wall_time = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  return answer;
}

}  // namespace accdec
