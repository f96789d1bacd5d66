#include <algorithm>
#include <cmath>

#include <accdec/machine/limits.hpp>
#include <accdec/motion/smallest_delay.hpp>
#include <accdec/task/delays_by_formula.hpp>
#include <accdec/task/objective.hpp>
#include <accdec/task/verifier.hpp>

namespace accdec {
namespace {

/// Slack for the choice alone: the simulated verification at the end has the last word with its own tolerance.
constexpr double slack = 1.0 + 0.9 * verification_tolerance;

/// Whether one axis holds its limits on a start to (or, mirrored in time, a stop from) `speed`, m/s: what no delay can
/// change.
bool ramp_holds(const Filter& filter, const Axis& axis, double speed, bool stop, double period) {
  AxisSampler sampler(axis, period);
  for (int k = 0; k <= filter.order() + settling; ++k) {
    const double v = speed * (stop ? filter.remaining(k) : filter.cumulative(k));
    const double acceleration = (stop ? -speed : speed) * filter.tap(k - 1) / period;
    if (!holds(axis, sampler.next(v, acceleration), slack)) return false;
  }
  return true;
}

bool ramps_hold(const Filter& filter, const Task& task) {
  for (const TaskCorner& corner : task.corners) {
    for (std::size_t a = 0; a < task.machine.axes.size(); ++a) {
      const auto i = static_cast<Eigen::Index>(a);
      const Corner& g = corner.geometry();
      if (!ramp_holds(filter, task.machine.axes[a], g.feed_in * g.direction_in[i], false, task.sample_period))
        return false;
      if (!ramp_holds(filter, task.machine.axes[a], g.feed_out * g.direction_out[i], true, task.sample_period))
        return false;
    }
  }
  return true;
}

/// The limits of one corner's blend, delay after delay. What failed at one delay most likely fails at the next at about
/// the same sample, so that sample is looked at first and most delays that will not do cost O(axes) instead of O(axes
/// N).
class BlendCheck {
 public:
  BlendCheck(const Filter& filter, const TaskCorner& corner, const Task& task)
      : filter_(filter), corner_(corner), task_(task) {
    const Corner& g = corner.geometry();
    for (std::size_t a = 0; a < task.machine.axes.size(); ++a) {
      const auto i = static_cast<Eigen::Index>(a);
      legs_.push_back({g.feed_in * g.direction_in[i], g.feed_out * g.direction_out[i]});
    }
  }

  bool holds(int delay) {
    const int last = filter_.order() + delay + settling;
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
    const double error = corner_error(Blend(filter_, corner_.geometry(), delay, task_.sample_period));
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
      AxisSampler sampler(axis, period);
      for (int i = std::max(k - AxisSampler::memory, 0); i < k; ++i)
        sampler.skip(tap_difference(legs_[a], i, delay) / period);
      speed_squared += v * v;
      // The member function of this class hides the function of the table.
      if (!accdec::holds(axis, sampler.next(v, tap_difference(legs_[a], k, delay) / period), slack)) return false;
    }
    return corner_.speed_min <= std::sqrt(speed_squared) * slack;
  }

  const Filter& filter_;
  const TaskCorner& corner_;
  const Task& task_;
  std::vector<Legs> legs_;
  int hint_ = 0;
};

}  // namespace

std::optional<std::vector<int>> delays_by_formula(const Filter& filter, const Task& task, double samples,
                                                  const std::function<bool()>& stop) {
  const DelayFinder smallest(filter);
  std::vector<int> delays;
  const LinearCost linear = cost_of(task);
  for (const TaskCorner& corner : task.corners) {
    const double step_in = corner.geometry().feed_in * task.sample_period,
                 step_out = corner.geometry().feed_out * task.sample_period;
    const int least =
        corner.error_max ? smallest(corner.geometry().cos_interior(), step_in, step_out, *corner.error_max * slack) : 0;
    delays.push_back(corner.delay.value_or(least));
  }
  double cost = linear(filter.order(), delays);
  // The error bounds alone already say which filters are too slow, long before their limits have to be looked at.
  if (cost >= samples || !ramps_hold(filter, task)) return std::nullopt;
  // Most filters that ring too much do so at an end or the middle of a band; only the others need the whole band
  // searched.
  for (const Mode& mode : task.machine.modes) {
    for (const double f : {mode.frequency_low, 0.5 * (mode.frequency_low + mode.frequency_high), mode.frequency_high}) {
      if (residual_vibration(filter, f, task.sample_period) > mode.residual_max * slack) return std::nullopt;
    }
  }
  for (const LimitUse& use : vibration_utilisation(filter, task.sample_period, task.machine, stop)) {
    if (use.utilisation > slack) return std::nullopt;
  }
  for (std::size_t j = 0; j < delays.size(); ++j) {
    const TaskCorner& corner = task.corners[j];
    // At N + 1 the legs no longer overlap, but the last step of one acceleration still meets the first of the other.
    const int last = corner.delay.value_or(std::max(delays[j], filter.order() + settling));
    BlendCheck check(filter, corner, task);
    for (;;) {
      if (stop && stop()) return std::nullopt;
      if (check.holds(delays[j])) break;
      cost += linear.delay[j];
      if (++delays[j] > last || cost >= samples) return std::nullopt;
    }
  }
  return delays;
}

}  // namespace accdec
