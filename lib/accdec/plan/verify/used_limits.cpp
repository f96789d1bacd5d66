#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <accdec/machine/limits.hpp>
#include <accdec/plan/verify/used_limits.hpp>
#include <accdec/plan/verify/verify_delay_kinds.hpp>
#include <accdec/task/verified_axes.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

/// An axis from rest on, by differences of its velocities.
class MovedAxis {
 public:
  MovedAxis(const std::vector<double>& velocity, const Axis& axis, double period)
      : velocity_(velocity), axis_(axis), period_(period) {}

  double velocity(std::size_t k) const { return velocity_[k]; }
  double acceleration(std::size_t k) const { return (velocity_[k] - (k > 0 ? velocity_[k - 1] : 0.0)) / period_; }
  double jerk(std::size_t k) const { return (acceleration(k) - (k > 0 ? acceleration(k - 1) : 0.0)) / period_; }
  double force(std::size_t k) const { return force_of(axis_, velocity(k), acceleration(k), period_); }
  double value(LimitKind kind, std::size_t k) const {
    switch (kind) {
      case LimitKind::velocity: return std::abs(velocity(k));
      case LimitKind::acceleration: return std::abs(acceleration(k));
      case LimitKind::jerk: return std::abs(jerk(k));
      case LimitKind::force: return std::abs(force(k));
      case LimitKind::power: return force(k) * velocity(k);
      case LimitKind::regeneration: return -force(k) * velocity(k);
      case LimitKind::force_speed: return axis_.force_speed.front().force * part_of_curve(axis_, velocity(k), force(k));
      case LimitKind::vibration:
      case LimitKind::residual:
      case LimitKind::corner_error:
      case LimitKind::speed_min:
      case LimitKind::power_total:
      case LimitKind::regeneration_total:
      case LimitKind::contour: break;  // of no one axis; named so that the compiler reports a missing new one
    }
    return 0.0;
  }

 private:
  const std::vector<double>& velocity_;
  const Axis& axis_;
  double period_;
};

}  // namespace

double force_of(const Axis& axis, double velocity, double acceleration, double period) {
  const double moving = axis.mass * acceleration + axis.damping * velocity, dry = axis.coulomb;
  if (velocity * period > position_floor) return moving + dry;
  if (velocity * period < -position_floor) return moving - dry;
  return moving > 0.0 ? std::max(0.0, moving - dry) : std::min(0.0, moving + dry);
}

/// The planner grants `position_floor`, and rounds as much otherwise.
double UseOfLimit::floor() const {
  return kind_ == LimitKind::contour ? 2.0 * position_floor : 0.0;
}

double UseOfLimit::use(double value) const {
  return value <= floor() ? 0.0 : utilisation_of(kind_, value, bound_);
}

UseOfLimit::Worst UseOfLimit::worst() const {
  Worst worst;
  for (std::size_t k = 0; k < motion_.velocity.front().size(); ++k) {
    const double value = value_(k), used = use(value);
    if (used > worst.use) worst = {used, value};
  }
  return worst;
}

bool UseOfLimit::is_worst(std::int64_t sample, const Worst& worst) const {
  if (worst.use == 0.0 && floor() == 0.0) return sample == 0;
  const std::int64_t k = motion_.kept(sample);
  if (k < 0 || k >= std::ssize(motion_.velocity.front())) return false;
  const double value = value_(static_cast<std::size_t>(k));
  if (floor() > 0.0) return std::abs(value - worst.value) <= 2.0 * rounding * bound_ + floor();
  return std::abs(use(value) - worst.use) <= 2.0 * rounding;
}

UseOfLimit use_of_axis(const DirectMotion& motion, const Axis& axis, std::size_t a, LimitKind kind, double period) {
  return {kind, axis.*axis_limit(kind).bound, motion,
          [moved = MovedAxis(motion.velocity[a], axis, period), kind](std::size_t k) { return moved.value(kind, k); }};
}

double rms_force(const DirectMotion& motion, const Axis& axis, std::size_t a, double period) {
  const MovedAxis moved(motion.velocity[a], axis, period);
  long double squares = 0.0L;  // rests that are left out have none
  for (std::size_t k = 0; k < motion.velocity[a].size(); ++k) {
    const long double force = moved.force(k);
    squares += force * force;
  }
  return static_cast<double>(std::sqrt(squares / static_cast<long double>(std::max<std::int64_t>(motion.samples, 1))));
}

UseOfLimit use_of_supply(const DirectMotion& motion, const Machine& machine, LimitKind kind, double period) {
  std::vector<MovedAxis> moved;
  for (std::size_t a = 0; a < machine.axes.size(); ++a) moved.emplace_back(motion.velocity[a], machine.axes[a], period);
  const bool motoring = kind == LimitKind::power_total;
  return {kind, motoring ? machine.power_total_max : machine.regeneration_total_max, motion,
          [moved = std::move(moved), motoring](std::size_t k) {
            double power = 0.0;
            for (const MovedAxis& axis : moved) power += axis.force(k) * axis.velocity(k);
            return motoring ? power : -power;
          }};
}

}  // namespace accdec
