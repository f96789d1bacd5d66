#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <accdec/certificate/constant_feed.hpp>
#include <accdec/certificate/interval.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

/// Whether a speed is beyond the curve's last one, or a force above the curve at a speed. With rounding granted, the
/// curve is larger by one factor.
bool above_curve(const Axis& axis, const Interval& speed, const Interval& force) {
  const std::vector<SpeedForce>& curve = axis.force_speed;
  const Interval granted = Interval(axis.force_speed_max) / Interval(curve.front().force);
  if (speed.lo > (granted * Interval(curve.back().speed)).hi || force.lo > axis.force_speed_max) return true;
  for (std::size_t i = 1; i < curve.size(); ++i) {
    const SpeedForce &a = curve[i - 1], &b = curve[i];
    // force (b.speed - a.speed) <= a.force (b.speed - speed) + b.force (speed - a.speed), all times the factor
    const Interval wide = Interval(b.speed) - Interval(a.speed), fall = Interval(a.force) - Interval(b.force);
    const Interval most = granted * (Interval(a.force) * wide + fall * Interval(a.speed));
    if ((force * wide + fall * speed).lo > most.hi) return true;
  }
  return false;
}

/// One leg at its feed: nothing accelerates, so the force is friction alone.
std::string broken_on_leg(const Axis& axis, const Interval& component, double feed) {
  const Interval speed = component.magnitude();
  // An axis that stands has no dry friction.
  const double dry = speed.lo > 1.1e-9 * feed ? axis.coulomb : 0.0;
  const Interval force = Interval(axis.damping) * speed + Interval(dry), power = force * speed;
  if (speed.lo > axis.velocity_max) return fmt::format("velocity {} is above its limit", axis.name);
  if (force.lo > axis.force_max) return fmt::format("friction alone takes more than force {}", axis.name);
  if (axis.force_speed_max < unlimited && above_curve(axis, speed, force))
    return fmt::format("friction alone takes more than the force-speed curve {}", axis.name);
  if (power.lo > axis.power_max) return fmt::format("friction alone takes more than power {}", axis.name);
  return {};
}

/// By how much time an axis lags behind a command of constant speed, s.
Interval lag(const Axis& axis, double period) {
  if (axis.response_taps.empty()) {
    if (axis.servo_gain == unlimited) return 0.0;
    return (Interval(1.0) - Interval(axis.velocity_feedforward)) / Interval(axis.servo_gain);
  }
  Interval sum = 0.0, late = 0.0;
  double samples = 0.0;
  for (const double tap : axis.response_taps)
    sum = sum + Interval(tap), late = late + Interval(tap) * Interval(samples++);
  return late / sum * Interval(period);
}

/// Whether axes that lag differently surely leave the line of a leg by more than a distance. Axes a and b leave it by
/// (lag_a - lag_b) v_a v_b/v in their plane. The squares of all pairs add up.
bool leaves_line(const Task& task, const Eigen::VectorXd& direction, double feed, double allowed) {
  Interval squares = 0.0;
  for (std::size_t a = 0; a < task.machine.axes.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      const Interval apart =
          lag(task.machine.axes[a], task.sample_period) - lag(task.machine.axes[b], task.sample_period);
      const Interval part = (apart * Interval(feed) * Interval(direction[static_cast<Eigen::Index>(a)]) *
                             Interval(direction[static_cast<Eigen::Index>(b)]))
                                .magnitude();
      squares = squares + part * part;
    }
  }
  return square_root(squares).lo > allowed;
}

/// A frequency n/T that an undamped mode's band holds: sum_i b_i exp(-2 pi j n i) is 1 for every filter.
std::string broken_by_sampling(const Mode& mode, double period) {
  if (!(mode.residual_max < 1.0) || !mode.undamped()) return {};
  const Interval low = Interval(mode.frequency_low) * Interval(period),
                 high = Interval(mode.frequency_high) * Interval(period);
  const double cycles = std::max(1.0, std::round(high.lo - 0.5 * (high.lo - low.hi)));
  for (double n = std::max(1.0, cycles - 1.0); n <= cycles + 1.0; n += 1.0) {
    // At the edge of a band the product is rounded: a difference as small as this counts as inside.
    if (low.lo <= n * (1.0 + 1e-12) && n * (1.0 - 1e-12) <= high.hi)
      return fmt::format("vibration: the band {:g} to {:g} Hz holds a multiple of the sample rate", mode.frequency_low,
                         mode.frequency_high);
  }
  // A band wider than the sample rate always holds one.
  if (high.lo - low.hi > 1.0) return "vibration: a band is wider than the sample rate";
  return {};
}

}  // namespace

std::string broken_at_constant_feed(const Task& written) {
  const Task task = granted_limits(written);
  for (const TaskCorner& corner : task.corners) {
    for (std::size_t i = 0; i < task.machine.axes.size(); ++i) {
      const auto a = static_cast<Eigen::Index>(i);
      const Axis& axis = task.machine.axes[i];
      for (const Interval& leg :
           {Interval(corner.geometry().feed_in) * Interval(corner.geometry().direction_in[a]),
            Interval(corner.geometry().feed_out) * Interval(corner.geometry().direction_out[a])}) {
        const std::string broken =
            broken_on_leg(axis, leg, std::max(corner.geometry().feed_in, corner.geometry().feed_out));
        if (!broken.empty()) return fmt::format("corner {}: {} at constant feed", corner.name, broken);
      }
    }
    const Corner& g = corner.geometry();
    if (corner.contour_max && (leaves_line(task, g.direction_in, g.feed_in, *corner.contour_max) ||
                               leaves_line(task, g.direction_out, g.feed_out, *corner.contour_max)))
      return fmt::format("corner {}: the servos leave the line of a leg at constant feed", corner.name);
    if (corner.speed_min > corner.geometry().feed_in || corner.speed_min > corner.geometry().feed_out)
      return fmt::format("corner {}: the smallest speed allowed is above the feed of a leg", corner.name);
  }
  for (const Mode& mode : task.machine.modes) {
    if (std::string broken = broken_by_sampling(mode, task.sample_period); !broken.empty()) return broken;
  }
  return {};
}

}  // namespace accdec
