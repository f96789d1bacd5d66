#include <algorithm>
#include <cmath>

#include <accdec/machine/limits.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/plan/feeds/feed_window.hpp>

namespace accdec {
namespace {

// Part of every limit to use, so that the march's own tolerance and rounding stay within the verifier's 1e-9.
constexpr double safe = 1.0 - 5e-6;

}  // namespace

std::array<int, 2> moving_averages(const Filter& filter) {
  const int first = filter.first_nonzero_tap(), last = filter.last_nonzero_tap(), count = last - first + 1;
  double largest = 0.0;
  for (int i = first; i <= last; ++i) largest = std::max(largest, filter.tap(i));
  const int longer = static_cast<int>(std::lround(1.0 / largest)), shorter = count + 1 - longer;
  if (shorter < 1 || shorter > longer) return {0, 0};
  const double scale = 1.0 / (static_cast<double>(longer) * shorter);
  for (int i = 0; i < count; ++i) {
    const int overlap = std::min({i + 1, count - i, shorter});
    if (std::abs(filter.tap(first + i) - overlap * scale) > 1e-9 * largest) return {0, 0};
  }
  return {longer, shorter};
}

FeedWindow::FeedWindow(const Filter& filter, const Machine& machine, double sample_period, std::size_t dimensions)
    : supply_(limits_supply(machine)),
      power_total_(machine.power_total_max),
      regeneration_total_(machine.regeneration_total_max),
      axes_(dimensions),
      machine_(machine.axes) {
  const double period = sample_period;
  const auto [longer, shorter] = moving_averages(filter);
  double largest = 0.0, steepest = 0.0;
  for (int i = 0; i <= filter.order() + 1; ++i) {
    largest = std::max(largest, filter.tap(i));
    steepest = std::max(steepest, std::abs(filter.tap(i) - filter.tap(i - 1)));
  }
  const int count = filter.last_nonzero_tap() - filter.first_nonzero_tap() + 1;
  tau1_ = longer > 0 ? longer * period : period / largest;
  const FilterBehind behind(filter, machine, period);
  half_ = 0.5 * (behind.ideal() ? count : behind.felt_order() - filter.first_nonzero_tap() + 1) * period;
  const double ramp = longer > 0 ? shorter * period : std::max(period, (count + 1) * period - tau1_);
  for (std::size_t a = 0; a < machine_.size(); ++a) {
    const Axis& axis = machine_[a];
    AxisWindow& window = axes_[a];
    window.change = axis.acceleration_max * tau1_;
    const double force = force_limit(axis);
    if (axis.mass > 0.0) window.change = std::min(window.change, force / axis.mass * tau1_);
    window.lines = force_lines(axis);
    if (!window.lines.empty()) window.fastest = last_speed(axis);
    if (axis.jerk_max < unlimited) {
      window.jerk = axis.jerk_max * period * period / steepest;
      tau2_ = ramp;
    }
    window.change *= safe;
    window.jerk *= safe;
    window.step = std::min(window.change, window.jerk);
    window.loaded = force < unlimited || axis.power_max < unlimited || axis.regeneration_max < unlimited;
    loads_ = loads_ || window.loaded;
    limited_ = limited_ || window.step < unlimited || window.loaded || supply_;
  }
}

bool FeedWindow::driven(const Axis& axis, double velocity, double before, bool mirrored) {
  // An axis with dry friction that reverses first brakes and then speeds up.
  const bool reverses = axis.coulomb > 0.0 && velocity * before < 0.0;
  return reverses || (std::abs(velocity) > std::abs(before)) != mirrored;
}

double FeedWindow::loaded_change(std::size_t axis, double velocity, double before, bool mirrored) const {
  const AxisWindow& window = axes_[axis];
  const Axis& limits = machine_[axis];
  const double v = std::max(std::abs(velocity), std::abs(before)), friction = limits.damping * v + limits.coulomb;
  double force = v > window.fastest ? -1.0 : limits.force_max;
  for (const ForceLine& line : window.lines) force = std::min(force, line.force - line.slope * v);
  if (driven(limits, velocity, before, mirrored)) {
    force = std::min(force - friction, v > 0.0 ? limits.power_max / v - friction : unlimited);
  } else if (v > 0.0) {
    force = std::min(force, limits.regeneration_max / v);
  }
  if (!(limits.mass > 0.0)) return force >= 0.0 ? window.change : 0.0;
  return std::min(window.change, safe * std::max(0.0, force) / limits.mass * tau1_);
}

double FeedWindow::supply_use(std::span<const double> velocities, std::span<const double> before, bool mirrored) const {
  double motoring = 0.0, braking = 0.0;
  for (std::size_t a = 0; a < machine_.size(); ++a) {
    const Axis& axis = machine_[a];
    const double v = std::max(std::abs(velocities[a]), std::abs(before[a])), friction = axis.damping * v + axis.coulomb;
    const double inertia = axis.mass * std::abs(velocities[a] - before[a]) / tau1_;
    if (driven(axis, velocities[a], before[a], mirrored)) {
      motoring += (inertia + friction) * v;
    } else {
      motoring += std::max(0.0, friction - inertia) * v;
      // Friction brakes, too. The power is largest at the speed F/(2 c), where F is the force without damping c.
      const double slower = std::min(std::abs(velocities[a]), std::abs(before[a])), left = inertia - axis.coulomb;
      const double at = axis.damping > 0.0 ? std::clamp(left / (2.0 * axis.damping), slower, v) : v;
      braking += std::max(0.0, left - axis.damping * at) * at;
    }
  }
  return std::max(motoring / power_total_, braking / regeneration_total_) / safe;
}

}  // namespace accdec
