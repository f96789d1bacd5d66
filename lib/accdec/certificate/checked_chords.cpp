#include <algorithm>
#include <cmath>
#include <numbers>

#include <accdec/certificate/checked_rows.hpp>

namespace accdec {
namespace {

void require_finite(double low, double high) {
  if (!std::isfinite(low) || !std::isfinite(high)) throw Rejected("an end of a chord is not a number");
}

Interval pick_sign(int sign) {
  return Interval(sign < 0 ? -1.0 : 1.0);
}

}  // namespace

std::optional<CheckedTube> CheckedRows::tube(const CheckedBox& box) const {
  return bounds_.tube(box.order, box.cuts);
}

bool CheckedRows::need_tube(CheckedBox& box) const {
  if (!box.tube && !box.nothing_left) {
    box.tube = tube(box);
    box.nothing_left = !box.tube;
  }
  return !box.nothing_left;
}

int CheckedRows::single_delay(int j, const CheckedBox& box) const {
  corner(j);
  const CheckedRange& r = box.corners[static_cast<std::size_t>(j)];
  if (r.d1 != r.d2) throw Rejected("a limit of the blend is used for several delays at once");
  return r.d1;
}

void CheckedRows::add_row(const proof::Response& row, const Interval& weight, CheckedBox& box, CheckedSum& sum) const {
  const int k = row.sample;
  if (k < 1 || k > sum.order() + longer()) return;  // no terms left
  if (!need_tube(box)) return;
  const CheckedTube& tube = *box.tube;
  const auto i = static_cast<std::size_t>(k);
  const bool upper = row.sign > 0;
  sum.response_behind(response_.motion(), k, upper ? weight : -1.0 * weight);
  sum.rhs = upper ? sum.rhs + weight * Interval(tube.high[i]) : sum.rhs - weight * Interval(tube.low[i]);
}

void CheckedRows::add_row(const proof::EventPower& row, const Interval& weight, CheckedBox& box,
                          CheckedSum& sum) const {
  if (row.sample < 1 || row.sample > sum.order() + longer() + 1) return;
  const Axis& x = axis(row.axis);
  const auto u = static_cast<std::size_t>(row.axis);
  const double speed = bounds_.event_speed(u, row.stop);
  const CheckedSpeeds legs = row.stop ? CheckedSpeeds{speed, 0.0} : CheckedSpeeds{0.0, speed};
  if (legs.in.hi == 0.0 && legs.out.hi == 0.0) throw Rejected("a multiplier names an axis that stands still");
  if (need_tube(box)) add_power(x, row.stop, legs, 0, row.sample, 1, row.low, row.high, weight, *box.tube, sum);
}

void CheckedRows::add_row(const proof::BlendPower& row, const Interval& weight, CheckedBox& box,
                          CheckedSum& sum) const {
  const int d = single_delay(row.corner, box);
  const Axis& x = axis(row.axis);
  if (row.sample < 1 || row.sample > sum.order() + longer() + d + 1) return;
  const auto u = static_cast<std::size_t>(row.axis);
  const CheckedSpeeds legs{checked_speed(corner(row.corner), u, true), checked_speed(corner(row.corner), u, false)};
  if (need_tube(box))
    add_power(x, row.regeneration, legs, d, row.sample, row.sign, row.low, row.high, weight, *box.tube, sum);
}

/// F <= P (1/l + 1/u - V/(l u)), times l/P. For V in [l, u] it holds because the hyperbola lies below its chord; for V
/// < l because the force is at most P/l there.
void CheckedRows::add_power(const Axis& axis, bool regeneration, const CheckedSpeeds& legs, int delay, int k, int sign,
                            double low, double high, const Interval& weight, const CheckedTube& tube,
                            CheckedSum& sum) const {
  const double bound = regeneration ? axis.regeneration_max : axis.power_max;
  require_limit(bound);
  if (axis.coulomb > 0.0) throw Rejected("a chord of power or regeneration is not known with dry friction");
  require_finite(low, high);
  if (!(low > 0.0) || !(high > low)) throw Rejected("a chord's ends are not 0 < low < high");
  const Interval in = pick_sign(sign) * legs.in, out = pick_sign(sign) * legs.out;
  const Interval range = in * (Interval(1.0) - tube.at(k)) + out * tube.at(k - delay);
  // Leg 1 lost its speed before leg 2 gains its own: the speed is between 0 and the legs' speeds.
  const double fastest = std::max({in.hi, out.hi, 0.0});
  if (std::min(range.hi, fastest) > high) throw Rejected("a chord ends below speeds that are left in its box");
  const double top = std::max(legs.in.magnitude().hi, legs.out.magnitude().hi);
  double cap = axis.force_max;
  if (axis.acceleration_max < unlimited)
    cap = std::min(cap, (Interval(axis.mass) * Interval(axis.acceleration_max) + Interval(axis.damping) * top).hi);
  const bool capped = cap < unlimited && (Interval(low) * Interval(cap)).hi <= bound;
  if (low > range.lo && !capped) throw Rejected("a chord begins above speeds that are left in its box");

  const Interval inertia = Interval(axis.mass) / period(), length(low), turned(regeneration ? -1.0 : 1.0);
  const auto add = [&](int at, const Interval& c) {
    sum.rhs = sum.rhs - c * in;
    sum.response_behind(response_.motion(), at, -1.0 * c * in);
    sum.response_behind(response_.motion(), at - delay, c * out);
  };
  add(k, weight * (turned * (inertia + Interval(axis.damping)) * length / Interval(bound) + 1.0 / Interval(high)));
  add(k - 1, -1.0 * weight * turned * inertia * length / Interval(bound));
  sum.rhs = sum.rhs + weight * (Interval(1.0) + length / Interval(high));
}

/// |V'| >= v_min in the sector of directions [low, high] from leg 1's: n V' >= v_min cos((high - low)/2), n in the
/// middle. With several delays, the smallest has the largest share of leg 2. This is the largest n V' if leg 2 points
/// along n.
void CheckedRows::add_row(const proof::Speed& row, const Interval& weight, CheckedBox& whole, CheckedSum& sum) const {
  const int k = row.sample;
  const double low = row.low, high = row.high;
  const TaskCorner& c = corner(row.corner);
  const CheckedRange& box = whole.corners[static_cast<std::size_t>(row.corner)];
  if (k < 1 || k > sum.order() + longer() + box.d1) return;
  if (!need_tube(whole)) return;
  const CheckedTube& tube = *whole.tube;
  require_finite(low, high);
  if (!(c.speed_min > 0.0)) throw Rejected("a multiplier names a limit that is not there");
  if (!(high > low) || !(high - low < std::numbers::pi)) throw Rejected("a sector of directions is no sector");
  const Interval in = Interval(c.geometry().feed_in) * (Interval(1.0) - tube.at(k)),
                 out = Interval(c.geometry().feed_out) * Interval(tube.at(k - box.d2).lo, tube.at(k - box.d1).hi);
  // Leg 2's direction in the plane of motion is (-cos theta, sin theta).
  const CheckedAngle interior = checked_angle(c.geometry());
  const Interval &cosine = interior.cosine, &sine = interior.sine;
  // The velocity is in (1, 0) + out (-cos, sin). It must not lie to the right of `low` or to the left of `high`.
  const auto left_of = [&](double angle) {
    const Interval ca = interval_cos(angle), sa = interval_sin(angle);
    return -1.0 * sa * in + (sine * ca + cosine * sa) * out;
  };
  const double middle = 0.5 * (low + high);
  const auto ahead_of = [&](double angle) {
    const Interval ca = interval_cos(angle), sa = interval_sin(angle);
    return ca * in + (sine * sa - cosine * ca) * out;
  };
  // Outside by as little as this counts as inside, and costs as little. Both edges of a sector no wider than that also
  // let directions behind it pass, so the middle is asked as well.
  const double outside = 1e-12 * std::max(c.geometry().feed_in, c.geometry().feed_out);
  if (left_of(low).lo < -outside || left_of(high).hi > outside || ahead_of(middle).lo < -outside)
    throw Rejected("a sector does not hold all directions that are left in its box");
  const Interval half = Interval(std::max(high - middle, middle - low)) + Interval(0.0, 1e-15);
  const Interval ca = interval_cos(middle), sa = interval_sin(middle);
  const Interval along_in = ca * Interval(c.geometry().feed_in) / Interval(c.speed_min);
  const Interval along_out = (sine * sa - cosine * ca) * Interval(c.geometry().feed_out) / Interval(c.speed_min);
  if (box.d1 != box.d2 && along_out.lo < 0.0)
    throw Rejected("a sector is used for several delays, but does not hold for all");
  // cos(half) - n V'/v_min <= 0
  sum.response_behind(response_.motion(), k, weight * along_in);
  sum.response_behind(response_.motion(), k - box.d1, -1.0 * weight * along_out);
  sum.rhs = sum.rhs + weight * (along_in - Interval(interval_cos(half).lo) + 2.0 * Interval(outside) / c.speed_min);
}

}  // namespace accdec
