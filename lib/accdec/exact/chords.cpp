#include <algorithm>
#include <cmath>
#include <numbers>

#include <accdec/exact/rows.hpp>

namespace accdec::exact {
namespace {

/// Chords reach this much beyond the tube (times the feed, or in rad), so that rounding never leaves it outside.
constexpr double reach = 1e-10;

double at(const std::vector<double>& sums, int k) {
  if (k <= 0) return 0.0;
  return k < static_cast<int>(sums.size()) - 1 ? sums[static_cast<std::size_t>(k)] : 1.0;
}

bool is_power(RowKind kind) {
  return kind == RowKind::power_start || kind == RowKind::blend_power;
}

}  // namespace

void LimitModel::find_families() {
  const auto add = [&](RowKind kind, std::size_t axis, int corner, int sign) {
    RowId id;
    id.kind = kind;
    id.axis = static_cast<int>(axis);
    id.corner = corner;
    id.sign = sign;
    const double bound = event_bound(id);
    const Axis& x = task_.machine.axes[axis];
    // Axes of the same plant: only the one that asks for most.
    for (RowId& old : families_) {
      const Axis& y = task_.machine.axes[static_cast<std::size_t>(old.axis)];
      if (corner >= 0 || old.kind != kind || x.mass != y.mass || x.damping != y.damping) continue;
      const auto speed = [](const Legs& v) { return v.in + v.out; };
      const double s = speed(event_legs(id)), t = speed(event_legs(old));
      const bool tighter = bound / (s * s) < event_bound(old) / (t * t);
      if (force_cap(id) / s != force_cap(old) / t) continue;
      if (tighter) old = id;
      return;
    }
    families_.push_back(id);
  };
  for (std::size_t a = 0; a < task_.machine.axes.size(); ++a) {
    const Axis& axis = task_.machine.axes[a];
    const bool power = axis.power_max < unlimited, regeneration = axis.regeneration_max < unlimited;
    if (power && speeds_[a].start > 0.0) add(RowKind::power_start, a, -1, 1);
    if (regeneration && speeds_[a].stop > 0.0) add(RowKind::regeneration_stop, a, -1, 1);
    for (std::size_t j = 0; j < corners(); ++j) {
      const Legs v = legs(task_.corners[j], a);
      if (v.in == 0.0 || v.out == 0.0) continue;
      for (const int sign : {1, -1}) {
        if (sign * v.in < 0.0 && sign * v.out < 0.0) continue;
        if (power) add(RowKind::blend_power, a, static_cast<int>(j), sign);
        if (regeneration) add(RowKind::blend_regeneration, a, static_cast<int>(j), sign);
      }
    }
  }
  for (std::size_t j = 0; j < corners(); ++j) {
    if (!(task_.corners[j].speed_min > 0.0)) continue;
    RowId id;
    id.kind = RowKind::speed;
    id.corner = static_cast<int>(j);
    families_.push_back(id);
  }
}

Legs LimitModel::event_legs(const RowId& id) const {
  if (id.kind == RowKind::power_start) return {0.0, speeds_[static_cast<std::size_t>(id.axis)].start};
  if (id.kind == RowKind::regeneration_stop) return {speeds_[static_cast<std::size_t>(id.axis)].stop, 0.0};
  const TaskCorner& c = task_.corners[static_cast<std::size_t>(id.corner)];
  if (id.kind == RowKind::speed) return {c.geometry().feed_in, c.geometry().feed_out};
  return legs(c, static_cast<std::size_t>(id.axis));
}

int LimitModel::event_delay(const RowId& id, const Box& box) const {
  return id.corner < 0 ? 0 : box.corners[static_cast<std::size_t>(id.corner)].d1;
}

double LimitModel::event_bound(const RowId& id) const {
  if (id.kind == RowKind::speed) return task_.corners[static_cast<std::size_t>(id.corner)].speed_min;
  const Axis& axis = task_.machine.axes[static_cast<std::size_t>(id.axis)];
  return is_power(id.kind) ? axis.power_max : axis.regeneration_max;
}

/// The most that force can be by the force and acceleration limits.
double LimitModel::force_cap(const RowId& id) const {
  const Axis& axis = task_.machine.axes[static_cast<std::size_t>(id.axis)];
  const Legs v = event_legs(id);
  const double fastest = std::max(std::abs(v.in), std::abs(v.out));
  return std::min(axis.force_max, axis.mass * axis.acceleration_max + axis.damping * fastest);
}

int LimitModel::last_sample(const RowId& id, const Box& box) const {
  return box.order + event_delay(id, box) + 1;
}

bool LimitModel::single_delay(const RowId& id, const Box& box) const {
  if (id.corner < 0 || id.kind == RowKind::speed) return true;
  const CornerBox& c = box.corners[static_cast<std::size_t>(id.corner)];
  return c.d1 == c.d2;
}

/// Of sign V_k.
LimitModel::Range LimitModel::speed_range(const RowId& id, const Box& box) const {
  const Legs v = event_legs(id);
  const int k = id.sample, m = k - event_delay(id, box);
  const double in = id.sign * v.in, out = id.sign * v.out;
  const auto most = [&](double leg, double low, double high) { return leg > 0.0 ? leg * high : leg * low; };
  const double stay_low = 1.0 - at(box.tube.high, k), stay_high = 1.0 - at(box.tube.low, k);
  const double go_low = at(box.tube.low, m), go_high = at(box.tube.high, m);
  return {-most(-in, stay_low, stay_high) - most(-out, go_low, go_high),
          std::min(most(in, stay_low, stay_high) + most(out, go_low, go_high), std::max({in, out, 0.0}))};
}

/// Of the direction of V'_k, in rad from leg 1's.
LimitModel::Range LimitModel::direction_range(const RowId& id, const Box& box) const {
  const auto j = static_cast<std::size_t>(id.corner);
  const Legs v = event_legs(id);
  const int k = id.sample;
  const double turn = std::numbers::pi - theta(j);
  const auto angle = [&](double in, double out) { return std::atan2(out * std::sin(turn), in + out * std::cos(turn)); };
  const double in_low = v.in * (1.0 - at(box.tube.high, k)), in_high = v.in * (1.0 - at(box.tube.low, k));
  const double out_low = v.out * at(box.tube.low, k - box.corners[j].d2);
  const double out_high = v.out * at(box.tube.high, k - box.corners[j].d1);
  if (out_high <= 0.0) return {0.0, 0.0};
  if (in_high <= 0.0) return {turn, turn};
  return {angle(in_high, out_low), angle(in_low, out_high)};
}

/// Whether a chord was drawn over all that the box's tube leaves.
bool LimitModel::covers(const RowId& id, const Box& box) const {
  if (static_cast<int>(box.tube.low.size()) != box.order + 2) return false;
  if (id.kind == RowKind::tube) return true;
  if (id.kind == RowKind::speed) {
    const Range r = direction_range(id, box);
    const CornerBox& c = box.corners[static_cast<std::size_t>(id.corner)];
    const double turn = std::numbers::pi - theta(static_cast<std::size_t>(id.corner));
    if (c.d1 < c.d2 && std::cos(turn - 0.5 * (id.low + id.high)) < 1e-9) return false;
    return id.low < r.low && r.high < id.high;
  }
  const Range r = speed_range(id, box);
  return r.high < id.high && (id.low < r.low || id.low * force_cap(id) < event_bound(id));
}

std::optional<RowId> LimitModel::chord(RowId id, const Box& box) const {
  if (id.kind == RowKind::speed) {
    const Range r = direction_range(id, box);
    id.low = r.low - reach;
    id.high = r.high + reach;
    if (!(id.high - id.low < std::numbers::pi)) return std::nullopt;
    // With several delays the least is the fastest, as long as leg 2 points the sector's way.
    const CornerBox& c = box.corners[static_cast<std::size_t>(id.corner)];
    const double turn = std::numbers::pi - theta(static_cast<std::size_t>(id.corner));
    if (c.d1 < c.d2 && std::cos(turn - 0.5 * (id.low + id.high)) < 1e-9) return std::nullopt;
    return id;
  }
  const Range r = speed_range(id, box);
  const double bound = event_bound(id), cap = force_cap(id);
  if (r.high <= 0.0 || r.high * cap <= bound) return std::nullopt;
  const Legs v = event_legs(id);
  const double beyond = reach * std::max(std::abs(v.in), std::abs(v.out));
  id.low = std::max(r.low - beyond, bound / cap * (1.0 - reach));
  id.high = r.high + beyond;
  if (!(id.low > 0.0)) return std::nullopt;
  return id;
}

std::optional<RowId> LimitModel::tangent(RowId id, const Filter& filter, const Box& box) const {
  const Legs v = event_legs(id);
  const int k = id.sample, m = k - event_delay(id, box);
  const double in = v.in * filter.remaining(k), out = v.out * filter.cumulative(m);
  if (use(id, filter, box) < 0.95) return std::nullopt;
  if (id.kind == RowKind::speed) {
    const double turn = std::numbers::pi - theta(static_cast<std::size_t>(id.corner));
    id.low = id.high = std::atan2(out * std::sin(turn), in + out * std::cos(turn));
    return id;
  }
  const double speed = id.sign * (in + out);
  if (!(speed > 0.0)) return std::nullopt;
  id.low = id.high = speed;
  return id;
}

double LimitModel::use(const RowId& id, const Filter& filter, const Box& box) const {
  const Legs v = event_legs(id);
  const int k = id.sample, d = event_delay(id, box);
  const auto speed = [&](int at) { return v.in * filter.remaining(at) + v.out * filter.cumulative(at - d); };
  if (id.kind == RowKind::speed) {
    const double in = v.in * filter.remaining(k), out = v.out * filter.cumulative(k - d);
    const double c = cos_interior(static_cast<std::size_t>(id.corner));
    return event_bound(id) / std::sqrt(std::max(1e-300, in * in + out * out - 2.0 * in * out * c));
  }
  const Axis& axis = task_.machine.axes[static_cast<std::size_t>(id.axis)];
  const double now = speed(k), before = speed(k - 1);
  const double force = axis.mass * (now - before) / task_.sample_period + axis.damping * now;
  if (id.sign * now <= 0.0) return 0.0;
  return (is_power(id.kind) ? force : -force) * now / event_bound(id);
}

double LimitModel::gather_close(const Filter& filter, const Box& box, std::vector<RowId>& close) const {
  double worst = 0.0;
  for (RowId id : families_) {
    for (id.sample = 1; id.sample <= last_sample(id, box); ++id.sample) {
      const double used = use(id, filter, box);
      worst = std::max(worst, used);
      const bool known = std::any_of(close.begin(), close.end(), [&](const RowId& c) { return same_limit(c, id); });
      if (used > 0.95 && !known) close.push_back(id);
    }
  }
  return worst;
}

SparseRow LimitModel::chord_row(const RowId& id, const Box& box) const {
  SparseRow row;
  const auto sum = [&](int k, double c) {  // c B_k
    if (k > box.order)
      row.constant += c;
    else if (k > 0 && c != 0.0)
      row.sums.emplace_back(k, c);
  };
  if (id.kind == RowKind::tube) {
    const auto k = static_cast<std::size_t>(id.sample);
    sum(id.sample, id.sign);
    row.constant = 1.0 - (id.sign > 0 ? box.tube.high[k] : -box.tube.low[k]);
    return row;
  }
  const Legs v = event_legs(id);
  const int k = id.sample, d = event_delay(id, box);
  const double bound = event_bound(id);
  if (id.kind == RowKind::speed) {
    const double middle = 0.5 * (id.low + id.high), half = 0.5 * (id.high - id.low);
    const double turn = std::numbers::pi - theta(static_cast<std::size_t>(id.corner));
    const double in = std::cos(middle) * v.in / bound, out = std::cos(turn - middle) * v.out / bound;
    row.constant = 1.0 + std::cos(half) - in;
    sum(k, in);
    sum(k - d, -out);
    return row;
  }
  const Axis& axis = task_.machine.axes[static_cast<std::size_t>(id.axis)];
  const double inertia = axis.mass / task_.sample_period;
  const double turned = is_power(id.kind) ? 1.0 : -1.0;
  const auto speed = [&](int at, double c) {
    row.constant += c * v.in;
    sum(at, -c * v.in);
    sum(at - d, c * v.out);
  };
  row.constant = -id.low / id.high;
  speed(k, id.sign * (turned * (inertia + axis.damping) * id.low / bound + 1.0 / id.high));
  speed(k - 1, -id.sign * turned * inertia * id.low / bound);
  return row;
}

std::vector<RowId> LimitModel::broken_chords(const Filter& filter, const Box& box, double slack) const {
  std::vector<RowId> broken;
  for (RowId id : families_) {
    if (!single_delay(id, box)) continue;
    for (id.sample = 1; id.sample <= last_sample(id, box); ++id.sample) {
      const auto drawn = chord(id, box);
      if (!drawn) continue;
      const SparseRow row = chord_row(*drawn, box);
      double value = row.constant;
      for (const auto& [k, c] : row.sums) value += c * filter.cumulative(k);
      if (value > 1.0 + slack) broken.push_back(*drawn);
    }
  }
  return broken;
}

}  // namespace accdec::exact
