#include <algorithm>
#include <cmath>

#include <accdec/plan/trajectory/available.hpp>

namespace accdec {
namespace {

/// Without any limit the motion would jump; this is beyond every machine and keeps ramps finite.
constexpr double no_machine = 1e6;  // m/s^2

double at_speed(const Axis& axis, double v) {
  double force = axis.force_max < unlimited ? axis.force_max - axis.damping * v : unlimited;
  if (v > 0.0) {
    if (axis.power_max < unlimited) force = std::min(force, axis.power_max / v - axis.damping * v);
    if (axis.regeneration_max < unlimited) {
      force =
          std::min(force, std::max(axis.regeneration_max / v, 2.0 * std::sqrt(axis.regeneration_max * axis.damping)));
    }
  }
  double acceleration = std::min(axis.acceleration_max, no_machine);
  if (force <= 0.0) return 0.0;
  if (force < unlimited && axis.mass > 0.0) acceleration = std::min(acceleration, force / axis.mass);
  return acceleration;
}

}  // namespace

AvailableAcceleration::AvailableAcceleration(const Machine& machine, double period, LastFilter last)
    : machine_(machine),
      period_(period),
      last_(std::move(last)),
      blur_(0.5 * period * (last_.filter().order() + 1) + period) {
  for (const Axis& axis : machine.axes) {
    depends_ =
        depends_ || axis.force_max < unlimited || axis.power_max < unlimited || axis.regeneration_max < unlimited;
  }
}

double AvailableAcceleration::of_axis(std::size_t axis, double speed) const {
  if (machine_.axes.empty()) return no_machine;
  const Axis& limits = machine_.axes[axis];
  double value = at_speed(limits, speed);
  // The velocity used to judge an acceleration is a mean over samples and the boxcar: up to this much later.
  if (depends_) value = at_speed(limits, speed + value * blur_);
  return std::min(value * margin, swing(axis));
}

double AvailableAcceleration::along(const double* u, std::size_t dimensions, double speed) const {
  double least = no_machine;
  for (std::size_t a = 0; a < dimensions; ++a) {
    const double part = std::abs(u[a]);
    if (part > 0.0) least = std::min(least, of_axis(a, speed * part) / part);
  }
  return least;
}

double AvailableAcceleration::feed(const double* u, std::size_t dimensions, double feed) const {
  for (std::size_t a = 0; a < dimensions && any(); ++a) {
    const double part = std::abs(u[a]);
    if (part > 0.0) feed = std::min(feed, machine_.axes[a].velocity_max * margin / part);
  }
  if (!depends_) return feed;
  // A speed whose friction takes the whole force is never reached: leave a hundredth of the acceleration at rest.
  const double least = 0.01 * along(u, dimensions, 0.0);
  if (along(u, dimensions, feed) >= least) return feed;
  double low = 0.0, high = feed;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (along(u, dimensions, middle) >= least ? low : high) = middle;
  }
  return low;
}

std::optional<double> longest_jerk_time(const Machine& machine, double fastest) {
  std::optional<double> longest;
  for (const Axis& axis : machine.axes) {
    if (!(axis.jerk_max < unlimited)) continue;
    double most = at_speed(axis, 0.0);
    if (most >= no_machine)
      most = std::min(most, std::sqrt(2.0 * std::min(fastest, axis.velocity_max) * axis.jerk_max));
    longest = std::max(longest.value_or(0.0), most / axis.jerk_max);
  }
  return longest;
}

}  // namespace accdec
