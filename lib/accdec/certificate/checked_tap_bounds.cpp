#include <algorithm>
#include <cmath>

#include <accdec/certificate/checked_tap_bounds.hpp>

namespace accdec {

std::optional<int> checked_differences(LimitKind kind) {
  switch (kind) {
    case LimitKind::acceleration: return 0;
    case LimitKind::jerk: return 1;
    case LimitKind::velocity:
    case LimitKind::force:
    case LimitKind::power:
    case LimitKind::regeneration:
    case LimitKind::force_speed:
    case LimitKind::vibration:
    case LimitKind::residual:
    case LimitKind::corner_error:
    case LimitKind::speed_min:
    case LimitKind::power_total:
    case LimitKind::regeneration_total:
    case LimitKind::contour: break;
  }
  return std::nullopt;
}

Interval checked_friction(const Axis& axis, bool stop) {
  return Interval(stop ? axis.coulomb : -axis.coulomb);
}

Interval checked_speed(const TaskCorner& c, std::size_t axis, bool in) {
  const auto a = static_cast<Eigen::Index>(axis);
  return in ? Interval(c.geometry().feed_in) * c.geometry().direction_in[a]
            : Interval(c.geometry().feed_out) * c.geometry().direction_out[a];
}

/// For nearly collinear legs the cosine gives the sine only to some 1e-8. The part of leg 2 across leg 1 is more
/// precise.
CheckedAngle checked_angle(const Corner& corner) {
  const double c = corner.cos_interior();
  const Interval cosine(std::nextafter(c, -2.0), std::nextafter(c, 2.0));
  Interval sine = square_root((Interval(1.0) - cosine) * (Interval(1.0) + cosine));
  Interval across(0.0);
  for (Eigen::Index a = 0; a < corner.axes(); ++a) {
    const Interval part = Interval(corner.direction_out[a]) + cosine * Interval(corner.direction_in[a]);
    const Interval size = part.magnitude();
    across = across + size * size;
  }
  across = square_root(across);
  sine.lo = std::max(sine.lo, across.lo), sine.hi = std::min(sine.hi, across.hi);
  return {cosine, sine};
}

CheckedTapBounds::CheckedTapBounds(const Task& task, const CheckedResponse& response) : longer_(response.longer()) {
  const Interval t(task.sample_period);
  for (std::size_t a = 0; a < task.machine.axes.size(); ++a) {
    const Axis& axis = task.machine.axes[a];
    double start = 0.0, stop = 0.0;
    for (const TaskCorner& c : task.corners) {
      // Lower ends: a slower leg needs less.
      const double in = checked_speed(c, a, true).magnitude().lo, out = checked_speed(c, a, false).magnitude().lo;
      start = std::max({start, in, in == 0.0 ? out : 0.0});
      stop = std::max({stop, out, out == 0.0 ? in : 0.0});
    }
    add_plants(axis, start, stop, t);
    start_.push_back(start);
    stop_.push_back(stop);
    if (std::max(start, stop) > 0.0) add_limits(axis, start, stop, t, response.ideal());
  }
  command_max_ = tap_max_;
  // The command has every designed tap times the largest of the smoothing.
  double largest = 0.0;
  for (const Interval& tap : response.command()) largest = std::max(largest, tap.lo);
  if (response.smooths()) tap_max_ = std::min(1.0, (Interval(command_max_) / Interval(largest)).hi);
}

void CheckedTapBounds::add_plants(const Axis& axis, double start, double stop, const Interval& period) {
  for (const bool ends : {false, true}) {
    const Interval s(ends ? stop : start);
    if (s.lo == 0.0) continue;
    CheckedPlant p{Interval(axis.mass) / period, Interval(axis.damping), {}, {}, {}, ends};
    const auto over = [](double bound, const Interval& by) {
      return bound < unlimited ? Interval(bound) / by : Interval(bound);
    };
    p.force = over((Interval(axis.force_max) + checked_friction(axis, ends)).hi, s);
    p.power = over(axis.power_max, s * s);
    // Without its dry friction a stop would brake more.
    p.regeneration = over(axis.coulomb > 0.0 ? unlimited : axis.regeneration_max, s * s);
    plants_.push_back(p);
  }
}

void CheckedTapBounds::add_limits(const Axis& axis, double start, double stop, const Interval& period, bool ideal) {
  const double fastest = std::max(start, stop);
  if (axis.acceleration_max < unlimited)
    tap_max_ = std::min(tap_max_, (Interval(axis.acceleration_max) * period / fastest).hi);
  for (const AxisLimit& limit : axis_limits) {
    const double bound = axis.*limit.bound;
    if (checked_differences(limit.kind).value_or(0) == 0 || !(bound < unlimited)) continue;
    Interval max = Interval(bound) * period / fastest;
    for (int n = *checked_differences(limit.kind); n > 0; --n) max = max * period;
    double& known = ramp_max_.try_emplace(limit.kind, unlimited).first->second;
    known = std::min(known, max.hi);
  }
  if (!ideal || !(axis.force_max < unlimited) || axis.damping != 0.0 || !(axis.mass > 0.0)) return;
  for (const bool ends : {false, true}) {
    const Interval inertia = Interval(axis.mass) * (ends ? stop : start);
    if (inertia.lo > 0.0)
      tap_max_ = std::min(tap_max_, ((Interval(axis.force_max) + checked_friction(axis, ends)) * period / inertia).hi);
  }
}

double CheckedTapBounds::ramp_max(LimitKind kind) const {
  const auto found = ramp_max_.find(kind);
  return found == ramp_max_.end() ? unlimited : found->second;
}

}  // namespace accdec
