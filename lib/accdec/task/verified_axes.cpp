#include <algorithm>
#include <cmath>
#include <utility>

#include <accdec/machine/limits.hpp>
#include <accdec/task/verified_axes.hpp>

namespace accdec {
namespace {

using Rows = std::pair<int, int>;  // [first, last]

/// Largest value of `quantity(row)` over the three events, with k counted within each.
template <class Quantity>
Peak peak_over_events(const SampledMotion& m, Quantity quantity) {
  Peak peak;
  bool any = false;
  const int last = static_cast<int>(m.velocity.rows()) - 1;
  const auto scan = [&](Event event, int zero, Rows rows) {
    for (int row = rows.first; row <= rows.second; ++row) {
      const double value = quantity(row);
      if (any && value <= peak.value) continue;
      // Among samples that differ only by rounding, readers expect the first.
      const bool clearly = !any || value > peak.value + 1e-12 * std::abs(peak.value);
      peak = clearly ? Peak{value, event, row - zero} : Peak{value, peak.event, peak.sample};
      any = true;
    }
  };
  scan(Event::start, m.start, {m.start, m.cruise_in});
  scan(Event::blend, m.corner, {m.corner, m.cruise_out});
  scan(Event::stop, m.stop, {m.stop, last});
  return peak;
}

/// Force of an axis at one row. Dry friction is against the motion. An axis slower than `still` stands: there it is
/// whatever makes the force smallest.
double force_at(const SampledMotion& m, const Axis& axis, Eigen::Index a, int row, double still) {
  const double moving = axis.mass * m.acceleration(row, a) + axis.damping * m.velocity(row, a);
  if (m.velocity(row, a) > still) return moving + axis.coulomb;
  if (m.velocity(row, a) < -still) return moving - axis.coulomb;
  return moving > 0.0 ? std::max(0.0, moving - axis.coulomb) : std::min(0.0, moving + axis.coulomb);
}

double first_of_curve(const Axis& axis) {
  return axis.force_speed.empty() ? 0.0 : axis.force_speed.front().force;
}

}  // namespace

double part_of_curve(const Axis& axis, double velocity, double force) {
  const double v = std::abs(velocity), f = std::abs(force);
  if (v == 0.0 && f == 0.0) return 0.0;
  // Corners of what is allowed: from the force at standstill along the curve, and down to the last speed.
  std::vector<SpeedForce> outline{{0.0, first_of_curve(axis)}};
  outline.insert(outline.end(), axis.force_speed.begin(), axis.force_speed.end());
  if (outline.back().speed > 0.0) outline.push_back({outline.back().speed, 0.0});
  for (std::size_t i = 0; i + 1 < outline.size(); ++i) {
    const SpeedForce &a = outline[i], &b = outline[i + 1];
    // The ray is between the two: their cross products with it have different signs.
    if (a.speed * f - a.force * v > 0.0 || b.speed * f - b.force * v < 0.0) continue;
    const double across = (b.speed - a.speed) * f - (b.force - a.force) * v,
                 twice_area = b.speed * a.force - a.speed * b.force;
    if (twice_area > 0.0) return across / twice_area;
  }
  return unlimited;
}

namespace {

/// Uses of the supply that the axes share.
void supply_uses(const SampledResponse& m, const Machine& machine, const std::string& corner, double still,
                 std::vector<LimitUse>& out) {
  const auto add = [&](LimitKind kind, double sign, double bound) {
    if (bound >= unlimited) return;
    const auto power = [&](int n) { return sign * total_power(m.motion(), machine, n, still); };
    out.push_back(make_use(kind, "", corner, peak_over_events(m.command, power), bound));
  };
  add(LimitKind::power_total, 1.0, machine.power_total_max);
  add(LimitKind::regeneration_total, -1.0, machine.regeneration_total_max);
}

}  // namespace

LimitUse make_use(LimitKind kind, const std::string& axis, const std::string& corner, const Peak& peak, double bound) {
  LimitUse use;
  use.kind = kind;
  use.axis = axis;
  use.corner = corner;
  use.event = peak.event;
  use.value = std::max(peak.value, 0.0);
  use.bound = bound;
  use.utilisation = utilisation_of(kind, use.value, bound);
  use.sample = peak.sample;
  return use;
}

double still_speed(const Corner& corner) {
  return 1e-9 * std::max(corner.feed_in, corner.feed_out);
}

double total_power(const SampledMotion& m, const Machine& machine, int row, double still) {
  double sum = 0.0;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const auto a = static_cast<Eigen::Index>(i);
    sum += force_at(m, machine.axes[i], a, row, still) * m.velocity(row, a);
  }
  return sum;
}

double axis_quantity(LimitKind kind, const SampledResponse& r, const Axis& axis, Eigen::Index a, int row,
                     double still) {
  const SampledMotion &c = r.command, &m = r.motion();
  const double force = force_at(m, axis, a, row, still);
  switch (kind) {
    case LimitKind::velocity: return std::abs(c.velocity(row, a));
    case LimitKind::acceleration: return std::abs(c.acceleration(row, a));
    case LimitKind::jerk: return std::abs(c.jerk(row, a));
    case LimitKind::force: return std::abs(force);
    case LimitKind::power: return force * m.velocity(row, a);
    case LimitKind::regeneration: return -force * m.velocity(row, a);
    case LimitKind::force_speed: return first_of_curve(axis) * part_of_curve(axis, m.velocity(row, a), force);
    case LimitKind::vibration:
    case LimitKind::corner_error:
    case LimitKind::speed_min:
    case LimitKind::power_total:
    case LimitKind::regeneration_total:
    case LimitKind::residual:
    case LimitKind::contour:
      break;  // of no one axis, or of no sample; named so that the compiler reports a missing new one
  }
  return 0.0;
}

void axis_uses(const SampledResponse& m, const Machine& machine, const std::string& corner, double still,
               std::vector<LimitUse>& out) {
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const Axis& axis = machine.axes[i];
    const auto a = static_cast<Eigen::Index>(i);
    const auto add = [&]<LimitKind kind>(double bound) {
      if (bound >= unlimited) return;
      out.push_back(make_use(
          kind, axis.name, corner,
          peak_over_events(m.command, [&](int n) { return axis_quantity(kind, m, axis, a, n, still); }), bound));
    };
    [&]<std::size_t... i>(std::index_sequence<i...>) {
      (add.template operator()<axis_limits[i].kind>(axis.*axis_limits[i].bound), ...);
    }
    (std::make_index_sequence<axis_limits.size()>{});
  }
  supply_uses(m, machine, corner, still, out);
}

}  // namespace accdec
