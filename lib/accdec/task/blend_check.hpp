#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <vector>

#include <accdec/corner.hpp>
#include <accdec/machine/blend_behind.hpp>
#include <accdec/machine/limits.hpp>
#include <accdec/task.hpp>
#include <accdec/task/blend_limits.hpp>
#include <accdec/verify.hpp>

// Internal to the room: whether one filter holds a task's limits, by formula.

namespace accdec {

/// Slack for choices by formula. The simulated verification at the end decides, with its own tolerance.
inline constexpr double formula_slack = 1.0 + 0.9 * verification_tolerance;

/// Whether a filter holds what delays do not change: starts, stops and vibrations. In delays_by_formula.cpp.
/// @param stop  polled; true ends it with any answer
bool holds_without_blends(const BlendLimits& limits, const Filter& filter, const Task& task,
                          const std::function<bool()>& stop);

/// The smallest delay at which a corner's error is at most `allowed`, m. @param finder  of the motion's filter
inline int delay_for_error(const DelayFinder& finder, const Corner& corner, double period, double allowed) {
  return finder(corner.cos_interior(), corner.feed_in * period, corner.feed_out * period, allowed);
}

/// The first delay from `from` to `last` that holds. None if none does, or if `ends` says after one that does not hold
/// that longer ones need not be tried.
template <class Holds, class Ends>
std::optional<int> first_delay(int from, int last, const Holds& holds, const Ends& ends) {
  for (int delay = from; delay <= last; ++delay) {
    if (holds(delay)) return delay;
    if (ends(delay)) break;
  }
  return std::nullopt;
}

/// The delay from which on longer ones change nothing. The phase between the legs still changes what a mode of an axis
/// is left with. There it is a period of the slowest mode more, and longer delays may hold what none up to it does.
int last_delay(const Task& task, int motion_order);

/// Whether a corner's start from rest and its stop hold their limits. Delays do not change this.
inline bool ramps_hold(const BlendLimits& limits, const LegVelocities& legs, double slack) {
  return limits.holds(legs.rest.data(), legs.in.data(), 0, slack) &&
         limits.holds(legs.out.data(), legs.rest.data(), 0, slack);
}

/// Checks one corner's blend for one delay after another.
class BlendCheck {
 public:
  /// @param behind  the designed filter behind the machine's response  @param limits  of the designed filter
  BlendCheck(const FilterBehind& behind, const TaskCorner& corner, const Task& task, const BlendLimits& limits)
      : behind_(behind), corner_(corner), period_(task.sample_period), limits_(limits), legs_(corner.geometry()) {}

  bool holds(int delay) {
    // The error first: it takes a few samples, the limits all of them, and most time.
    return error_holds(delay) && speed_use(delay) <= formula_slack && contour_use(delay) <= formula_slack &&
           limits_hold(delay, formula_slack);
  }

  /// Whether a longer delay may hold where this one does not. If the legs do not turn back, the corner becomes only
  /// slower; not so if axes differ or overshoot.
  bool longer_may_hold(int delay) const {
    if (!(corner_.speed_min > 0.0) || behind_.differs()) return true;
    double along = 0.0;
    for (std::size_t a = 0; a < legs_.in.size(); ++a) along += legs_.in[a] * legs_.out[a];
    const Corner& g = corner_.geometry();
    return along < -1e-12 * g.feed_in * g.feed_out || speed_use(delay) <= formula_slack;
  }

  /// The cheapest part of it.
  bool error_holds(int delay) const { return error_use(delay) <= formula_slack; }

  /// The same with rounding allowed for, the start from rest and the stop included.
  Verdict verdict(int delay) {
    double most = error_use(delay);
    if (verdict_by_formula(most) != Verdict::broken) most = std::max({most, speed_use(delay), contour_use(delay)});
    const Verdict corner = verdict_by_formula(most);
    if (corner == Verdict::broken) return corner;
    if (all_hold(delay, surely_granted)) return corner;
    return all_hold(delay, 1.0 + granted_tolerance) ? Verdict::close : Verdict::broken;
  }

 private:
  double error_use(int delay) const {
    if (!corner_.error_max) return 0.0;
    const double error = corner_error(behind_, corner_.geometry(), delay, period_);
    return utilisation_of(LimitKind::corner_error, judged_distance(error), *corner_.error_max);
  }
  double contour_use(int delay) const {
    if (!corner_.contour_max) return 0.0;
    const double deviation = measure(behind_, corner_.geometry(), delay, period_).contour_deviation;
    return utilisation_of(LimitKind::contour, judged_distance(deviation), *corner_.contour_max);
  }
  double speed_use(int delay) const {
    if (!(corner_.speed_min > 0.0)) return 0.0;
    double least = unlimited;
    const int last = behind_.longest_order() + delay + settling;
    for (int k = 0; k <= last; ++k) {
      double speed_squared = 0.0;
      for (std::size_t a = 0; a < legs_.in.size(); ++a) {
        const Filter& motion = behind_.motion(a);
        const double v = legs_.in[a] * motion.remaining(k) + legs_.out[a] * motion.cumulative(k - delay);
        speed_squared += v * v;
      }
      least = std::min(least, speed_squared);
    }
    return utilisation_of(LimitKind::speed_min, std::sqrt(least), corner_.speed_min);
  }
  bool limits_hold(int delay, double slack) {
    return limits_.holds(legs_.in.data(), legs_.out.data(), delay, slack, &hint_);
  }
  bool all_hold(int delay, double slack) { return limits_hold(delay, slack) && ramps_hold(limits_, legs_, slack); }

  const FilterBehind& behind_;
  const TaskCorner& corner_;
  double period_;
  const BlendLimits& limits_;
  LegVelocities legs_;
  int hint_ = 0;
};

}  // namespace accdec
