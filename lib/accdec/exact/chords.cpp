#include <algorithm>
#include <cmath>
#include <numbers>

#include <accdec/exact/chords.hpp>

namespace accdec::exact {
namespace {

/// Chords reach this much beyond the tube (times the feed, or in rad), so that rounding never leaves it outside.
constexpr double reach = 1e-10;

double at(const std::vector<double>& sums, int k) {
  if (k <= 0) return 0.0;
  return k < static_cast<int>(sums.size()) - 1 ? sums[static_cast<std::size_t>(k)] : 1.0;
}

}  // namespace

proof::Row row_of(const Chord& c) {
  const ChordFamily& f = c.family;
  if (f.kind == ChordFamily::speed) return proof::Speed{*f.corner, c.sample, c.low, c.high};
  const bool regeneration = f.kind == ChordFamily::regeneration;
  if (!f.corner) return proof::EventPower{regeneration, f.axis, c.sample, c.low, c.high};
  return proof::BlendPower{regeneration, *f.corner, f.axis, c.sample, f.sign, c.low, c.high};
}

std::optional<Chord> chord_of(const proof::Row& row) {
  const auto kind = [](bool regeneration) { return regeneration ? ChordFamily::regeneration : ChordFamily::power; };
  if (const auto* r = std::get_if<proof::EventPower>(&row))
    return Chord{{kind(r->stop), std::nullopt, r->axis, 1}, r->sample, r->low, r->high};
  if (const auto* r = std::get_if<proof::BlendPower>(&row))
    return Chord{{kind(r->regeneration), r->corner, r->axis, r->sign}, r->sample, r->low, r->high};
  if (const auto* r = std::get_if<proof::Speed>(&row))
    return Chord{{ChordFamily::speed, r->corner, 0, 1}, r->sample, r->low, r->high};
  return std::nullopt;
}

Chords::Chords(const Task& task, const ConvexRows& rows) : task_(task), rows_(rows), speeds_(event_speeds(task)) {
  find_families();
}

void Chords::add_family(const ChordFamily& family) {
  // Axes of the same plant: only the one that asks for most.
  for (ChordFamily& old : families_) {
    const Axis &x = axis(family), &y = axis(old);
    if (family.corner || old.corner || old.kind != family.kind || x.mass != y.mass || x.damping != y.damping) continue;
    const auto speed = [](const Legs& v) { return v.in + v.out; };
    const double s = speed(event_legs(family)), t = speed(event_legs(old));
    const bool tighter = bound(family) / (s * s) < bound(old) / (t * t);
    if (force_cap(family) / s != force_cap(old) / t) continue;
    if (tighter) old = family;
    return;
  }
  families_.push_back(family);
}

void Chords::find_families() {
  for (std::size_t i = 0; i < task_.machine.axes.size(); ++i) {
    const Axis& axis = task_.machine.axes[i];
    const bool power = axis.power_max < unlimited, regeneration = axis.regeneration_max < unlimited;
    const int a = static_cast<int>(i);
    if (power && speeds_[i].start > 0.0) add_family({ChordFamily::power, std::nullopt, a, 1});
    if (regeneration && speeds_[i].stop > 0.0) add_family({ChordFamily::regeneration, std::nullopt, a, 1});
    for (std::size_t j = 0; j < task_.corners.size(); ++j) {
      const Legs v = legs(task_.corners[j], i);
      if (v.in == 0.0 || v.out == 0.0) continue;
      for (const int sign : {1, -1}) {
        if (sign * v.in < 0.0 && sign * v.out < 0.0) continue;
        if (power) add_family({ChordFamily::power, static_cast<int>(j), a, sign});
        if (regeneration) add_family({ChordFamily::regeneration, static_cast<int>(j), a, sign});
      }
    }
  }
  for (std::size_t j = 0; j < task_.corners.size(); ++j) {
    if (task_.corners[j].speed_min > 0.0) families_.push_back({ChordFamily::speed, static_cast<int>(j), 0, 1});
  }
}

const Axis& Chords::axis(const ChordFamily& family) const {
  return task_.machine.axes[static_cast<std::size_t>(family.axis)];
}

double Chords::cosine(const ChordFamily& family) const {
  return task_.corners[static_cast<std::size_t>(*family.corner)].geometry().cos_interior();
}

/// rad, by which leg 2 turns away from leg 1.
double Chords::turn(const ChordFamily& family) const {
  const double c = cosine(family);
  return std::numbers::pi - std::atan2(std::sqrt(std::max(0.0, (1.0 - c) * (1.0 + c))), c);
}

Legs Chords::event_legs(const ChordFamily& family) const {
  const EventSpeeds& speeds = speeds_[static_cast<std::size_t>(family.axis)];
  if (!family.corner) return family.kind == ChordFamily::power ? Legs{0.0, speeds.start} : Legs{speeds.stop, 0.0};
  const TaskCorner& c = task_.corners[static_cast<std::size_t>(*family.corner)];
  if (family.kind == ChordFamily::speed) return {c.geometry().feed_in, c.geometry().feed_out};
  return legs(c, static_cast<std::size_t>(family.axis));
}

int Chords::event_delay(const ChordFamily& family, const Box& box) const {
  return family.corner ? box.corner(*family.corner).d1 : 0;
}

double Chords::bound(const ChordFamily& family) const {
  if (family.kind == ChordFamily::speed) return task_.corners[static_cast<std::size_t>(*family.corner)].speed_min;
  return family.kind == ChordFamily::power ? axis(family).power_max : axis(family).regeneration_max;
}

/// Largest force that the force and acceleration limits allow.
double Chords::force_cap(const ChordFamily& family) const {
  const Axis& x = axis(family);
  const Legs v = event_legs(family);
  const double fastest = std::max(std::abs(v.in), std::abs(v.out));
  return std::min(x.force_max, x.mass * x.acceleration_max + x.damping * fastest);
}

int Chords::last_sample(const ChordFamily& family, const Box& box) const {
  return order(box) + event_delay(family, box) + 1;
}

bool Chords::single_delay(const ChordFamily& family, const Box& box) const {
  if (!family.corner || family.kind == ChordFamily::speed) return true;
  const CornerBox& c = box.corner(*family.corner);
  return c.d1 == c.d2;
}

/// Range of sign V_k.
Chords::Range Chords::speed_range(const ChordFamily& family, int k, const Box& box) const {
  const Legs v = event_legs(family);
  const int m = k - event_delay(family, box);
  const double in = family.sign * v.in, out = family.sign * v.out;
  const auto most = [&](double leg, double low, double high) { return leg > 0.0 ? leg * high : leg * low; };
  const double stay_low = 1.0 - at(box.tube.high, k), stay_high = 1.0 - at(box.tube.low, k);
  const double go_low = at(box.tube.low, m), go_high = at(box.tube.high, m);
  return {-most(-in, stay_low, stay_high) - most(-out, go_low, go_high),
          std::min(most(in, stay_low, stay_high) + most(out, go_low, go_high), std::max({in, out, 0.0}))};
}

/// Range of the direction of V'_k, in rad from leg 1's direction.
Chords::Range Chords::direction_range(const ChordFamily& family, int k, const Box& box) const {
  const CornerBox& c = box.corner(*family.corner);
  const Legs v = event_legs(family);
  const double turned = turn(family);
  const auto angle = [&](double in, double out) {
    return std::atan2(out * std::sin(turned), in + out * std::cos(turned));
  };
  const double in_low = v.in * (1.0 - at(box.tube.high, k)), in_high = v.in * (1.0 - at(box.tube.low, k));
  const double out_low = v.out * at(box.tube.low, k - c.d2);
  const double out_high = v.out * at(box.tube.high, k - c.d1);
  if (out_high <= 0.0) return {0.0, 0.0};
  if (in_high <= 0.0) return {turned, turned};
  return {angle(in_high, out_low), angle(in_low, out_high)};
}

bool Chords::covers(const Chord& chord, const Box& box) const {
  const ChordFamily& family = chord.family;
  if (family.kind == ChordFamily::speed) {
    const Range r = direction_range(family, chord.sample, box);
    const CornerBox& c = box.corner(*family.corner);
    if (c.d1 < c.d2 && std::cos(turn(family) - 0.5 * (chord.low + chord.high)) < 1e-9) return false;
    return chord.low < r.low && r.high < chord.high;
  }
  const Range r = speed_range(family, chord.sample, box);
  return r.high < chord.high && (chord.low < r.low || chord.low * force_cap(family) < bound(family));
}

std::optional<Chord> Chords::draw(const ChordFamily& family, int sample, const Box& box) const {
  if (family.kind == ChordFamily::speed) {
    const Range r = direction_range(family, sample, box);
    const Chord chord{family, sample, r.low - reach, r.high + reach};
    if (!(chord.high - chord.low < std::numbers::pi)) return std::nullopt;
    // With several delays, the smallest one gives the fastest speed, as long as leg 2 points into the sector's half
    // plane.
    const CornerBox& c = box.corner(*family.corner);
    if (c.d1 < c.d2 && std::cos(turn(family) - 0.5 * (chord.low + chord.high)) < 1e-9) return std::nullopt;
    return chord;
  }
  const Range r = speed_range(family, sample, box);
  const double most = bound(family), cap = force_cap(family);
  if (r.high <= 0.0 || r.high * cap <= most) return std::nullopt;
  const Legs v = event_legs(family);
  const double beyond = reach * std::max(std::abs(v.in), std::abs(v.out));
  const Chord chord{family, sample, std::max(r.low - beyond, most / cap * (1.0 - reach)), r.high + beyond};
  if (!(chord.low > 0.0)) return std::nullopt;
  return chord;
}

std::optional<Chord> Chords::tangent(const Chord& chord, const Filter& motion, const Box& box, double least_use) const {
  const ChordFamily& family = chord.family;
  const Legs v = event_legs(family);
  const int k = chord.sample, m = k - event_delay(family, box);
  const double in = v.in * motion.remaining(k), out = v.out * motion.cumulative(m);
  if (use(family, k, motion, box) < least_use) return std::nullopt;
  if (family.kind == ChordFamily::speed) {
    const double turned = turn(family);
    const double direction = std::atan2(out * std::sin(turned), in + out * std::cos(turned));
    return Chord{family, k, direction, direction};
  }
  const double speed = family.sign * (in + out);
  if (!(speed > 0.0)) return std::nullopt;
  return Chord{family, k, speed, speed};
}

double Chords::use(const ChordFamily& family, int k, const Filter& motion, const Box& box) const {
  const Legs v = event_legs(family);
  const int d = event_delay(family, box);
  const auto speed = [&](int at) { return v.in * motion.remaining(at) + v.out * motion.cumulative(at - d); };
  if (family.kind == ChordFamily::speed) {
    const double in = v.in * motion.remaining(k), out = v.out * motion.cumulative(k - d);
    return bound(family) / std::sqrt(std::max(1e-300, in * in + out * out - 2.0 * in * out * cosine(family)));
  }
  const Axis& x = axis(family);
  const double now = speed(k), before = speed(k - 1);
  const double force = x.mass * (now - before) / task_.sample_period + x.damping * now;
  if (family.sign * now <= 0.0) return 0.0;
  return (family.kind == ChordFamily::power ? force : -force) * now / bound(family);
}

double Chords::gather_close(const Filter& filter, const Box& box, std::vector<Chord>& close) const {
  double worst = 0.0;
  std::optional<Filter> made;
  const Filter& motion = rows_.motion().behind(filter, made);
  for (const ChordFamily& family : families_) {
    for (int k = 1; k <= last_sample(family, box); ++k) {
      const double used = use(family, k, motion, box);
      worst = std::max(worst, used);
      const bool known =
          std::any_of(close.begin(), close.end(), [&](const Chord& c) { return c.sample == k && c.family == family; });
      if (used > 0.95 && !known) close.push_back({family, k, 0.0, 0.0});
    }
  }
  return worst;
}

namespace {

/// Adds c B_k.
void add_response(SparseRow& row, int order, int k, double c) {
  if (k > order)
    row.constant += c;
  else if (k > 0 && c != 0.0)
    row.sums.emplace_back(k, c);
}

}  // namespace

SparseRow Chords::speed_row(const Chord& chord, const Box& box) const {
  const ChordFamily& family = chord.family;
  const Legs v = event_legs(family);
  const double middle = 0.5 * (chord.low + chord.high), half = 0.5 * (chord.high - chord.low);
  const double in = std::cos(middle) * v.in / bound(family);
  const double out = std::cos(turn(family) - middle) * v.out / bound(family);
  SparseRow row;
  row.of_motion = rows_.servo();
  row.constant = 1.0 + std::cos(half) - in;
  add_response(row, order(box), chord.sample, in);
  add_response(row, order(box), chord.sample - event_delay(family, box), -out);
  return row;
}

SparseRow Chords::row(const Chord& chord, const Box& box) const {
  const ChordFamily& family = chord.family;
  if (family.kind == ChordFamily::speed) return speed_row(chord, box);
  const Legs v = event_legs(family);
  const int k = chord.sample, d = event_delay(family, box);
  const Axis& x = axis(family);
  const double most = bound(family), inertia = x.mass / task_.sample_period;
  const double turned = family.kind == ChordFamily::power ? 1.0 : -1.0;
  SparseRow row;
  row.of_motion = rows_.servo();
  const auto speed = [&](int at, double c) {
    row.constant += c * v.in;
    add_response(row, order(box), at, -c * v.in);
    add_response(row, order(box), at - d, c * v.out);
  };
  row.constant = -chord.low / chord.high;
  speed(k, family.sign * (turned * (inertia + x.damping) * chord.low / most + 1.0 / chord.high));
  speed(k - 1, -family.sign * turned * inertia * chord.low / most);
  return row;
}

std::vector<Chord> Chords::broken(const Filter& filter, const Box& box, double slack) const {
  std::vector<Chord> broken;
  std::optional<Filter> made;
  const Filter& motion = rows_.motion().behind(filter, made);
  for (const ChordFamily& family : families_) {
    if (!single_delay(family, box)) continue;
    for (int k = 1; k <= last_sample(family, box); ++k) {
      const auto drawn = draw(family, k, box);
      if (!drawn) continue;
      const SparseRow cut = row(*drawn, box);
      double value = cut.constant;
      for (const auto& [i, c] : cut.sums) value += c * motion.cumulative(i);
      if (value > 1.0 + slack) broken.push_back(*drawn);
    }
  }
  return broken;
}

}  // namespace accdec::exact
