#include <algorithm>
#include <cmath>
#include <numbers>

#include <accdec/machine/limits.hpp>
#include <accdec/task/blend_limits.hpp>

namespace accdec {

BlendLimits::BlendLimits(const Filter& filter, const Machine& machine, double sample_period)
    : behind_(filter, machine, sample_period),
      filter_(behind_.command()),
      machine_(machine),
      period_(sample_period),
      dry_(has_dry_friction(machine)) {
  for (int i = 0; i <= filter_.order() + 1; ++i) {
    peak_tap_ = std::max(peak_tap_, filter_.tap(i));
    peak_step_ = std::max(peak_step_, std::abs(filter_.tap(i) - filter_.tap(i - 1)));
  }
  for (std::size_t a = 0; a < machine.axes.size(); ++a) {
    if (limited(machine.axes[a])) limited_.push_back(a);
  }
  for (const Mode& mode : machine.modes) {
    if (!mode.of_axis()) continue;
    const auto at_end = [&](double f) {
      return residual_amplitude(filter_, 0.0, 1.0, 0, f, period_, mode.damping_low) / mode.displacement_max;
    };
    residuals_.push_back({&mode,
                          residual_utilisation(filter_, 0.0, 1.0, 0, period_, mode).utilisation,
                          {at_end(mode.frequency_low), at_end(mode.frequency_high)}});
    slowest_ = std::max(slowest_, static_cast<int>(std::min(1e6, std::ceil(1.0 / (mode.frequency_low * period_)))));
  }
}

AxisState BlendLimits::peak_at(const Axis& axis, double speed) const {
  return peak_of(axis, speed, speed * peak_tap_ / period_, speed * peak_step_ / (period_ * period_));
}

AxisState BlendLimits::peak_of(const Axis& axis, double velocity, double acceleration, double jerk) const {
  AxisState peak = axis_state(axis, velocity, acceleration, jerk);
  if (behind_.gain() > 1.0) peak = with_load(peak, axis, behind_.gain() * velocity, behind_.gain() * acceleration);
  peak.braking = peak.motoring;  // a stop brakes as a start drives
  return peak;
}

namespace {

/// The largest factor at which a limit holds that is the easier to hold the smaller the factor.
template <class Holds>
double largest_factor(const Holds& holds) {
  constexpr double least = 1e-6;
  if (holds(1.0)) return 1.0;
  double low = 0.0, high = 1.0;
  while (high - low > 1e-9 * high && high > least) {
    const double middle = 0.5 * (low + high);
    (holds(middle) ? low : high) = middle;
  }
  return std::max(low, least);
}

}  // namespace

double BlendLimits::start_factor(const double* velocity, Binding* binding) const {
  double factor = 1.0;
  const auto allow = [&](double allowed, LimitKind kind, std::size_t axis) {
    if (allowed >= factor) return;
    factor = allowed;
    if (binding != nullptr) *binding = {kind, axis};
  };
  for (const std::size_t a : limited_) {
    const Axis& axis = machine_.axes[a];
    const double v = std::abs(velocity[a]);
    if (v == 0.0) continue;
    const AxisState peak = peak_at(axis, v);
    for (const AxisLimit& limit : axis_limits) {
      const double value = limit.value(peak), bound = axis.*limit.bound;
      if (!(value > bound)) continue;
      // Dry friction does not become smaller with the speed.
      const bool scales = !limit.load || axis.coulomb == 0.0;
      const double part = limit.degree == 2 ? std::sqrt(bound / value) : bound / value;
      allow(scales ? part : largest_factor([&](double f) { return limit.value(peak_at(axis, f * v)) <= bound; }),
            limit.kind, a);
    }
  }
  for (const SupplyLimit& limit : supply_limits) {
    const double bound = machine_.*limit.bound;
    if (!(bound < unlimited)) continue;
    const auto holds = [&](double f) {
      double power = 0.0;
      for (std::size_t a = 0; a < machine_.axes.size(); ++a)
        power += peak_at(machine_.axes[a], f * std::abs(velocity[a])).motoring;
      return power <= bound;
    };
    allow(largest_factor(holds), limit.kind, machine_.axes.size());
  }
  for (const Residual& residual : residuals_) {
    const auto a = static_cast<std::size_t>(residual.mode->axis);
    const double use = std::abs(velocity[a]) * residual.of_one;
    if (use > 1.0) allow(1.0 / use, LimitKind::residual, a);
  }
  return factor;
}

bool BlendLimits::any_delay_holds(const double* in, const double* out, int from) const {
  if (limits_supply(machine_) || !residuals_.empty()) return false;  // not known without the samples
  return std::ranges::all_of(limited_,
                             [&](std::size_t a) { return surely_holds(machine_.axes[a], in[a], out[a], from); });
}

bool BlendLimits::surely_holds(const Axis& axis, double in, double out, int from) const {
  const bool merge = from == 0;  // without delay the steps merge
  const double v1 = std::abs(in), v2 = std::abs(out), change = std::abs(out - in);
  // The steps of both legs add where they point apart.
  const double apart = in * out < 0.0 ? v1 + v2 : std::max(v1, v2);
  const double acceleration = (merge ? change : apart) * peak_tap_ / period_;
  const double jerk = (merge ? change : v1 + v2) * peak_step_ / (period_ * period_);
  return accdec::holds(axis, peak_of(axis, std::max(v1, v2), acceleration, jerk), 1.0);
}

namespace {

/// Speed below which an axis stands still, of legs with these velocities.
double still_speed(const double* in, const double* out, std::size_t axes) {
  double fastest = 0.0;
  for (std::size_t a = 0; a < axes; ++a) fastest = std::max({fastest, std::abs(in[a]), std::abs(out[a])});
  return still_part * fastest;
}

}  // namespace

namespace {

/// Whether no limit of the axis is of another kind than velocity, acceleration and jerk.
bool limits_motion_only(const Axis& axis) {
  return !limited_beside(axis, {LimitKind::velocity, LimitKind::acceleration, LimitKind::jerk});
}

}  // namespace

bool BlendLimits::sample_holds(std::size_t a, double in, double out, int delay, int k, double slack,
                               double still) const {
  const Axis& axis = machine_.axes[a];
  const auto acceleration = [&](int i) {
    return (out * filter_.tap(i - 1 - delay) - in * filter_.tap(i - 1)) / period_;
  };
  AxisSampler sampler(axis, period_, still);
  for (int i = std::max(k - AxisSampler::memory, 0); i < k; ++i) sampler.skip(acceleration(i));
  return accdec::holds(axis, state(sampler, axis, in, out, delay, k, still), slack);
}

AxisState BlendLimits::state(AxisSampler& sampler, const Axis& axis, double in, double out, int delay, int k,
                             double still) const {
  const auto velocity = [&](const Filter& filter) {
    return in * filter.remaining(k) + out * filter.cumulative(k - delay);
  };
  const auto acceleration = [&](const Filter& filter) {
    return (out * filter.tap(k - 1 - delay) - in * filter.tap(k - 1)) / period_;
  };
  const AxisState command = sampler.next(velocity(filter_), acceleration(filter_));
  if (behind_.ideal()) return command;
  const Filter& motion = behind_.motion(static_cast<std::size_t>(&axis - machine_.axes.data()));
  return with_load(command, axis, velocity(motion), acceleration(motion), still);
}

bool BlendLimits::holds(const double* in, const double* out, int delay, double slack, int* hint) const {
  if (any_delay_holds(in, out, delay)) return true;
  return axes_hold(in, out, delay, slack, hint) && residuals_hold(in, out, delay, slack);
}

namespace {

/// Speed that two legs give a mode together, by the rest of leg 1's swing after the delay and the angle it turned by.
double together(double v1, double v2, double rest, double cosine) {
  return std::sqrt(std::max(0.0, v2 * v2 + rest * v1 * (rest * v1 - 2.0 * v2 * cosine)));
}

/// The largest cosine from one angle to a larger one.
double largest_cosine(double from, double to) {
  constexpr double turn = 2.0 * std::numbers::pi;
  return std::floor(to / turn) > std::floor(from / turn) || from <= 0.0 ? 1.0 : std::max(std::cos(from), std::cos(to));
}

/// An upper bound of that speed over a mode's ranges.
double together_most(const Mode& mode, double v1, double v2, double seconds) {
  const double low = 2.0 * std::numbers::pi * mode.frequency_low * seconds,
               high = 2.0 * std::numbers::pi * mode.frequency_high * seconds;
  const double from = low * std::sqrt(1.0 - mode.damping_high * mode.damping_high),
               to = high * std::sqrt(1.0 - mode.damping_low * mode.damping_low);
  const double cosine =
      v1 * v2 > 0.0 ? -largest_cosine(from + std::numbers::pi, to + std::numbers::pi) : largest_cosine(from, to);
  // The square is convex in what is left of leg 1's swing.
  return std::max(together(v1, v2, std::exp(-mode.damping_low * low), cosine),
                  together(v1, v2, std::exp(-mode.damping_high * high), cosine));
}

}  // namespace

bool BlendLimits::residuals_hold(const double* in, const double* out, int delay, double slack) const {
  return std::ranges::all_of(residuals_, [&](const Residual& residual) {
    const auto a = static_cast<std::size_t>(residual.mode->axis);
    const double v1 = in[a], v2 = out[a];
    const Mode& mode = *residual.mode;
    if (v1 == 0.0 || v2 == 0.0) return std::max(std::abs(v1), std::abs(v2)) * residual.of_one <= slack;
    const double seconds = delay * period_;
    if (together_most(mode, v1, v2, seconds) * residual.of_one <= slack) return true;
    // Most delays that fail do so at an end of the ranges.
    for (const bool end : {false, true}) {
      const double swing = 2.0 * std::numbers::pi * (end ? mode.frequency_high : mode.frequency_low) * seconds;
      const double turned = swing * std::sqrt(1.0 - mode.damping_low * mode.damping_low);
      const double legs = together(v1, v2, std::exp(-mode.damping_low * swing), std::cos(turned));
      if (legs * residual.at_end[end ? 1 : 0] > slack * (1.0 + 1e-12)) return false;
    }
    return residual_utilisation(filter_, v1, v2, delay, period_, mode).utilisation <= slack;
  });
}

bool BlendLimits::axes_hold(const double* in, const double* out, int delay, double slack, int* hint) const {
  const int last = behind_.longest_order() + delay + settling;
  const double still = dry_ ? still_speed(in, out, machine_.axes.size()) : 0.0;
  if (hint != nullptr) {
    for (const int k : {*hint, *hint + 1}) {
      for (const std::size_t a : limited_)
        if (k <= last && !sample_holds(a, in[a], out[a], delay, k, slack, still)) return false;
    }
  }
  for (const std::size_t a : limited_) {
    if (slack >= 1.0 && surely_holds(machine_.axes[a], in[a], out[a], delay)) continue;
    const int broken = first_broken(machine_.axes[a], in[a], out[a], delay, last, slack, still);
    if (broken < 0) continue;
    if (hint != nullptr) *hint = broken;
    return false;
  }
  return supply_holds(in, out, delay, slack, still);
}

int BlendLimits::first_broken(const Axis& axis, double in, double out, int delay, int last, double slack,
                              double still) const {
  if (limits_motion_only(axis)) {
    // The same at a fraction of the time. Between the legs no axis is faster than on the faster one.
    if (std::max(std::abs(in), std::abs(out)) > axis.velocity_max * slack) return 0;
    const double step_max = axis.acceleration_max * slack * period_,
                 change_max = axis.jerk_max * slack * period_ * period_;
    double before = 0.0;
    for (int k = 0; k <= last; ++k) {
      const double step = out * filter_.tap(k - 1 - delay) - in * filter_.tap(k - 1);
      if (std::abs(step) > step_max || std::abs(step - before) > change_max) return k;
      before = step;
    }
    return -1;
  }
  AxisSampler sampler(axis, period_, still);
  for (int k = 0; k <= last; ++k) {
    if (!accdec::holds(axis, state(sampler, axis, in, out, delay, k, still), slack)) return k;
  }
  return -1;
}

bool BlendLimits::supply_holds(const double* in, const double* out, int delay, double slack, double still) const {
  if (!limits_supply(machine_)) return true;
  std::vector<AxisSampler> samplers;
  for (const Axis& axis : machine_.axes) samplers.emplace_back(axis, period_, still);
  for (int k = 0; k <= behind_.longest_order() + delay + settling; ++k) {
    double power = 0.0;
    for (std::size_t a = 0; a < samplers.size(); ++a)
      power += state(samplers[a], machine_.axes[a], in[a], out[a], delay, k, still).motoring;
    if (power > machine_.power_total_max * slack || -power > machine_.regeneration_total_max * slack) return false;
  }
  return true;
}

int BlendLimits::smallest(const double* in, const double* out, int from, bool& possible, bool stop) const {
  if (any_delay_holds(in, out, from)) return from;
  const bool alone = !stop || std::ranges::all_of(residuals_, [&](const Residual& residual) {
    const auto a = static_cast<std::size_t>(residual.mode->axis);
    return std::max(std::abs(in[a]), std::abs(out[a])) * residual.of_one <= surely_granted;
  });
  const auto held = [&](int delay) {
    return axes_hold(in, out, delay, surely_granted, nullptr) &&
           (stop || residuals_hold(in, out, delay, surely_granted));
  };
  if (alone && held(from)) return from;
  // Legs that do not overlap change only the phase of modes with their delay.
  const int apart = behind_.longest_order() + settling, last = stop ? apart : apart + slowest_;
  if (alone && from < last && axes_hold(in, out, apart, surely_granted, nullptr)) {
    for (int delay = from + 1; delay <= last; ++delay) {
      if (held(delay)) return delay;
    }
  }
  possible = false;
  return from;
}

LegVelocities::LegVelocities(const Corner& corner) : rest(static_cast<std::size_t>(corner.axes()), 0.0) {
  for (Eigen::Index i = 0; i < corner.axes(); ++i) {
    in.push_back(corner.feed_in * corner.direction_in[i]);
    out.push_back(corner.feed_out * corner.direction_out[i]);
  }
}

}  // namespace accdec
