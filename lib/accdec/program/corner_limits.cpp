#include <accdec/program/corner_limits.hpp>

#include <algorithm>
#include <cmath>

#include <accdec/design/verifier.hpp>

namespace accdec {
namespace {
constexpr double slack = 1.0 + 0.5 * verification_tolerance;  // leaves room for the rounding of the simulation
}

CornerLimits::CornerLimits(const Filter& filter, const Machine& machine, double sample_period)
    : filter_(filter), machine_(machine), period_(sample_period) {
  for (int i = 0; i <= filter.order() + 1; ++i) {
    tap_max_ = std::max(tap_max_, filter.tap(i));
    tap_step_max_ = std::max(tap_step_max_, std::abs(filter.tap(i) - filter.tap(i - 1)));
  }
  for (std::size_t a = 0; a < machine.axes.size(); ++a) {
    const Axis& axis = machine.axes[a];
    if (std::min({axis.velocity_max, axis.acceleration_max, axis.jerk_max, axis.force_max, axis.power_max,
                  axis.regeneration_max}) < unlimited) {
      limited_.push_back(a);
    }
  }
}

double CornerLimits::start_factor(const double* velocity) const {
  double factor = 1.0;
  for (const std::size_t a : limited_) {
    const Axis& axis = machine_.axes[a];
    const double v = std::abs(velocity[a]), acceleration = v * tap_max_ / period_;
    if (v == 0.0) continue;
    const double jerk = v * tap_step_max_ / (period_ * period_), force = axis.mass * acceleration + axis.damping * v;
    const double power = std::min(axis.power_max, axis.regeneration_max);
    factor = std::min({factor, axis.velocity_max / v, axis.acceleration_max / acceleration, axis.jerk_max / jerk});
    if (force > 0.0) factor = std::min({factor, axis.force_max / force, std::sqrt(power / (force * v))});
  }
  return factor;
}

bool CornerLimits::any_delay_holds(const double* in, const double* out, int from) const {
  for (const std::size_t a : limited_) {
    const Axis& axis = machine_.axes[a];
    const double v1 = std::abs(in[a]), v2 = std::abs(out[a]), v = std::max(v1, v2);
    // The steps of both legs add where they point apart; without delay they merge to one.
    const double change = from == 0 ? std::abs(out[a] - in[a]) : 0.0;
    const double apart = in[a] * out[a] < 0.0 ? v1 + v2 : v;
    const double step = from == 0 ? change : apart;
    const double acceleration = step * tap_max_ / period_;
    const double jerk = (from == 0 ? change : v1 + v2) * tap_step_max_ / (period_ * period_);
    const double force = axis.mass * acceleration + axis.damping * v;
    if (v > axis.velocity_max || acceleration > axis.acceleration_max || jerk > axis.jerk_max || force > axis.force_max ||
        force * v > axis.power_max || force * v > axis.regeneration_max) {
      return false;
    }
  }
  return true;
}

bool CornerLimits::holds(const double* in, const double* out, int delay) const {
  for (const std::size_t a : limited_) {
    const Axis& axis = machine_.axes[a];
    const double v1 = in[a], v2 = out[a];
    double before = 0.0;
    const int last = filter_.order() + 2 + delay;
    for (int k = 0; k <= last; ++k) {
      const double v = v1 * filter_.remaining(k) + v2 * filter_.cumulative(k - delay);
      const double acceleration = (v2 * filter_.tap(k - 1 - delay) - v1 * filter_.tap(k - 1)) / period_;
      const double force = axis.mass * acceleration + axis.damping * v, power = force * v;
      if (std::abs(v) > axis.velocity_max * slack || std::abs(acceleration) > axis.acceleration_max * slack ||
          std::abs(acceleration - before) > axis.jerk_max * period_ * slack || std::abs(force) > axis.force_max * slack ||
          power > axis.power_max * slack || -power > axis.regeneration_max * slack) {
        return false;
      }
      before = acceleration;
    }
  }
  return true;
}

int CornerLimits::smallest(const double* in, const double* out, int from, bool& possible) const {
  if (any_delay_holds(in, out, from) || holds(in, out, from)) return from;
  const int apart = filter_.order() + 2;
  if (from >= apart || !holds(in, out, apart)) {
    possible = false;
    return from;
  }
  int delay = from + 1;
  while (delay < apart && !holds(in, out, delay)) ++delay;
  return delay;
}

}  // namespace accdec
