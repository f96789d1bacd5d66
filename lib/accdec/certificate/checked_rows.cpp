#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <accdec/certificate/checked_rows.hpp>
#include <accdec/machine/limits.hpp>

namespace accdec {

void require_limit(double bound) {
  if (!(bound < unlimited)) throw Rejected("a multiplier names a limit that is not there");
}

namespace {

/// Adds c times the n-th difference at `at` of the terms that `term` adds; every difference is multiplied by `step`.
template <class Term>
void add_difference(int n, int at, const Interval& c, const Interval& step, const Term& term) {
  if (n == 0) return term(at, c);
  add_difference(n - 1, at, c * step, step, term);
  add_difference(n - 1, at - 1, -1.0 * c * step, step, term);
}

/// |F| + slope |V'| <= bound
struct CheckedForce {
  Interval bound, slope{0.0};
};

CheckedForce largest_force(const Axis& axis) {
  require_limit(axis.force_max);
  return {Interval(axis.force_max)};
}

/// The line through two neighbours of the curve, or the constant before the first point.
CheckedForce checked_line(const Axis& axis, int line) {
  const std::vector<SpeedForce>& curve = axis.force_speed;
  require_limit(axis.force_speed_max);
  if (line < 0 || line >= static_cast<int>(curve.size()))
    throw Rejected("a multiplier names a line that its force-speed curve does not have");
  const Interval granted = Interval(axis.force_speed_max) / Interval(curve.front().force);
  if (line == 0) return {Interval(axis.force_speed_max)};
  const SpeedForce &a = curve[static_cast<std::size_t>(line) - 1], &b = curve[static_cast<std::size_t>(line)];
  const Interval slope = (Interval(a.force) - Interval(b.force)) / (Interval(b.speed) - Interval(a.speed));
  return {granted * (Interval(a.force) + slope * Interval(a.speed)), slope};
}

}  // namespace

CheckedRows::CheckedRows(const Task& task) : task_(task), response_(task), bounds_(task, response_) {}

const TaskCorner& CheckedRows::corner(int j) const {
  if (j < 0 || j >= static_cast<int>(task_.corners.size()))
    throw Rejected("a multiplier names a corner that is not there");
  return task_.corners[static_cast<std::size_t>(j)];
}

const Axis& CheckedRows::axis(int a) const {
  if (a < 0 || a >= static_cast<int>(task_.machine.axes.size()))
    throw Rejected("a multiplier names an axis that is not there");
  return task_.machine.axes[static_cast<std::size_t>(a)];
}

void CheckedRows::add(const proof::Term& term, CheckedBox& box, CheckedSum& sum) const {
  const double y = term.multiplier;
  if (!(y >= 0.0) || !std::isfinite(y)) throw Rejected("a multiplier is negative or not a number");
  if (box.window) require_inside(term.row, box);
  const auto add = [&]<class Row>(const Row& row) {
    const Interval before = sum.rhs;
    const long terms = sum.terms;
    add_row(row, Interval(y), box, sum);
    // At constant speed a limit says nothing about the taps. If it holds, the proof does without the row: multipliers
    // serve several parts, and in some parts their rows are at samples past the end.
    if constexpr (std::is_same_v<Row, proof::Blend> || std::is_same_v<Row, proof::BlendPower> ||
                  std::is_same_v<Row, proof::Reversal> || std::is_same_v<Row, proof::EventForce> ||
                  std::is_same_v<Row, proof::EventPower>) {
      if (sum.terms == terms && (sum.rhs - before).lo > 0.0) sum.rhs = before;
    }
  };
  std::visit(add, term.row);
}

void CheckedRows::require_inside(const proof::Row& row, const CheckedBox& box) const {
  // A tap of the command is made of designed taps up to it, as many before it as the smoothing has.
  const int smoothing = static_cast<int>(response_.command().size()) - 1;
  const auto inside = [&](int tap) { return tap - smoothing >= 1 && tap < box.order; };
  // The rest of a damped vibration depends on how far the filter's end is.
  const auto* vibration = std::get_if<proof::Vibration>(&row);
  bool all = std::holds_alternative<proof::Error>(row) ||
             (vibration != nullptr && vibration->damping == 0.0 && vibration->corner < 0 && !response_.smooths());
  if (const auto* difference = std::get_if<proof::TapDifference>(&row)) {
    const int newest = difference->sample, oldest = newest - checked_differences(difference->limit).value_or(0);
    all = inside(newest) && inside(oldest);
  }
  // Rows of forces behind a servo have weights for the taps beyond.
  const bool servo = response_.motion().size() > response_.command().size();
  if (const auto* force = std::get_if<proof::EventForce>(&row)) all = servo || inside(force->sample - 1);
  if (const auto* blend = std::get_if<proof::Blend>(&row)) {
    corner(blend->corner);
    const int d = single_delay(blend->corner, box), newest = blend->sample - 1;
    const std::optional<int> differences = checked_differences(blend->limit);
    const int oldest = newest - differences.value_or(0);
    all = !differences && servo;
    if (!all) all = std::ranges::all_of(std::array{newest, newest - d, oldest, oldest - d}, inside);
  }
  if (!all) throw Rejected("a multiplier names a limit beyond its window");
}

void CheckedRows::add_row(const proof::TapDifference& row, const Interval& weight, CheckedBox&, CheckedSum& sum) const {
  const std::optional<int> n = checked_differences(row.limit);
  if (!n) throw Rejected("a multiplier names a difference that no limit bounds");
  const double max = *n == 0 ? bounds_.command_max() : bounds_.ramp_max(row.limit);
  require_limit(max);
  if (row.sample < 0 || row.sample > sum.order() + static_cast<int>(response_.command().size()) - 1 + *n) return;
  const Interval c = weight * (row.sign < 0 ? -1.0 : 1.0) / Interval(max);
  add_difference(*n, row.sample, c, Interval(1.0),
                 [&](int i, const Interval& f) { sum.tap_behind(response_.command(), i, f); });
  sum.rhs = sum.rhs + weight;
}

void CheckedRows::add_row(const proof::EventForce& row, const Interval& weight, CheckedBox&, CheckedSum& sum) const {
  const int k = row.sample;
  if (k < 1 || k > static_cast<int>(sum.taps.size() + response_.motion().size()) - 1) return;
  const Axis& x = axis(row.axis);
  const CheckedForce force = row.line < 0 ? largest_force(x) : checked_line(x, row.line);
  const double speed = bounds_.event_speed(static_cast<std::size_t>(row.axis), row.stop);
  // At a start drag and the line's fall both add to the force; at a stop drag brakes.
  const Interval drag = row.stop ? Interval(x.damping) - force.slope : Interval(x.damping) + force.slope;
  const Interval scale = weight * speed / force.bound;
  sum.tap_behind(response_.motion(), k - 1, scale * Interval(x.mass) / period());
  sum.response_behind(response_.motion(), k, scale * drag);
  sum.rhs = sum.rhs + weight;
  if (row.stop) sum.rhs = sum.rhs + scale * drag;
  sum.rhs = sum.rhs + weight * checked_friction(x, row.stop) / force.bound;
}

void CheckedRows::add_row(const proof::Error& row, const Interval& weight, CheckedBox& box, CheckedSum& sum) const {
  const TaskCorner& c = corner(row.corner);
  if (box.instants) {
    response_.require_ideal();
    return add_error_at_instant(row, c, period(), weight, box, sum);
  }
  if (!c.error_max) throw Rejected("a multiplier names a limit that is not there");
  const CheckedRange& r = box.corners[static_cast<std::size_t>(row.corner)];
  const auto [cosine, sine] = checked_angle(c.geometry());
  const Interval ca = interval_cos(Interval(row.angle)), sa = interval_sin(Interval(row.angle));
  const double fastest = std::max(c.geometry().feed_in, c.geometry().feed_out);
  const Interval wp = weight * ca * Interval(c.geometry().feed_in) / Interval(fastest);
  const Interval wq = weight * (cosine * ca + sine * sa) * Interval(c.geometry().feed_out) / Interval(fastest);
  Interval p = wp, q = wq;
  if (box.window && (wp.lo < 0.0 || wq.lo < 0.0)) throw Rejected("a tangent cut does not apply to a whole window");
  if (r.k1 < r.k2 || r.d1 < r.d2) {
    // Within a box p and q are only bounded below. A weight below zero by more than rounding would need an upper bound.
    if (wp.hi < 0.0 || wq.hi < 0.0) throw Rejected("a tangent cut does not apply to a whole box");
    p.lo = std::max(p.lo, 0.0), q.lo = std::max(q.lo, 0.0);
    // If rounding leaves the sign open, use the most that a negative weight could take away: p <= N, and as much more
    // as the response is long; q <= k - d.
    if (wp.lo < 0.0) {
      p = Interval(0.0);
      sum.rhs = sum.rhs + Interval(-wp.lo) * static_cast<double>(sum.taps.size() + static_cast<std::size_t>(longer()));
    }
    if (wq.lo < 0.0) {
      q = Interval(0.0);
      sum.rhs = sum.rhs + Interval(-wq.lo) * static_cast<double>(std::max(0, r.k2 - r.d1));
    }
  }
  const int n = sum.order();
  // Taps beyond a window's last one have a smaller part in q than the last one, and from there on none.
  const int m = box.window ? std::min(r.k1 - r.d2, n) : r.k1 - r.d2;
  // So do the taps before a window's first one: their part in p is at least nothing.
  for (int i = box.window && !response_.ideal() ? 1 : std::max(0, r.k2 + 1 - longer()); i <= n; ++i)
    sum.tap(i, p * response_.left(i - r.k2));
  for (int i = 0; i <= std::min(n, m - 1); ++i) sum.tap(i, q * response_.gone(m - i));
  const Interval error(*c.error_max);
  sum.rhs = sum.rhs + weight * error / (period() * Interval(fastest));
}

/// In the wedge of both legs, the nearer one is min(p, q) sin(theta) away. Linearly between samples, p falls and q
/// rises. So it keeps the tolerance if and only if both are at most that over
/// sin(theta) at some time c. For c in c1 .. c2, p(c) >= p(c2) and q(c - d) >= q(c1 - d2).
void CheckedRows::add_row(const proof::Contour& row, const Interval& weight, CheckedBox& box, CheckedSum& sum) const {
  const TaskCorner& c = corner(row.corner);
  if (!c.contour_max) throw Rejected("a multiplier names a limit that is not there");
  const CheckedRange& r = box.corners[static_cast<std::size_t>(row.corner)];
  const Interval sine = checked_angle(c.geometry()).sine;
  if (!(sine.lo > 0.0)) throw Rejected("a contour tolerance says nothing of collinear legs");
  const double fastest = std::max(c.geometry().feed_in, c.geometry().feed_out);
  const double time = row.out ? r.c1 - r.d2 : r.c2, whole = std::floor(time);
  if (!(std::abs(time) < 1e8)) throw Rejected("a contour's time is out of range");
  // c1 - d2 may round; q does not fall, so the part is taken low there.
  const Interval part =
      row.out ? (Interval(r.c1) - Interval(r.d2)) - Interval(whole) : Interval(time) - Interval(whole);
  const Interval rest = Interval(1.0) - part;
  const int k = static_cast<int>(whole), n = sum.order();
  const Interval scale = weight * Interval(row.out ? c.geometry().feed_out : c.geometry().feed_in) / Interval(fastest);
  for (int i = row.out ? 0 : std::max(0, k + 1 - longer()); i <= (row.out ? std::min(n, k) : n); ++i) {
    const Interval here = row.out ? response_.gone(k - i) : response_.left(i - k),
                   next = row.out ? response_.gone(k + 1 - i) : response_.left(i - k - 1);
    sum.tap(i, scale * (rest * here + part * next));
  }
  sum.rhs = sum.rhs + weight * Interval(*c.contour_max) / (period() * Interval(fastest) * sine);
}

void CheckedRows::add_row(const proof::Vibration& row, const Interval& weight, CheckedBox& box, CheckedSum& sum) const {
  if (row.mode < 0 || row.mode >= static_cast<int>(task_.machine.modes.size()))
    throw Rejected("a multiplier names a mode that is not there");
  const Mode& mode = task_.machine.modes[static_cast<std::size_t>(row.mode)];
  if (!(row.frequency >= mode.frequency_low && row.frequency <= mode.frequency_high))
    throw Rejected("a multiplier's frequency is outside its band");
  if (!(row.damping >= mode.damping_low && row.damping <= mode.damping_high && row.damping < 1.0))
    throw Rejected("a multiplier's damping is outside its range");
  const Interval natural = two_pi() * Interval(row.frequency) * period(), z(row.damping);
  const bool damped = row.damping > 0.0;
  const Interval w = damped ? natural * square_root((Interval(1.0) - z) * (Interval(1.0) + z)) : natural;
  // From tap i on, the vibration falls until the last tap of the longest filter of the part. Shorter filters have
  // fallen less there, so what they leave is bounded, too.
  const Interval fall = damped ? interval_exp(-1.0 * natural * z) : Interval(1.0);
  Interval fallen = weight;
  const std::size_t commands = sum.taps.size() + response_.command().size() - 1;
  for (std::size_t i = commands; i-- > 0;) {
    // The taps that an end of the window stands for may have any phase.
    const bool end = box.window && (i == 0 || i + 1 == commands);
    const Interval phase = end ? Interval(-1.0) : interval_cos(w * static_cast<double>(i) - Interval(row.angle));
    sum.tap_behind(response_.command(), static_cast<int>(i), fallen * phase);
    if (damped) fallen = fallen * fall;
  }
  sum.rhs = sum.rhs + weight * bound_of_mode(row, mode, box);
}

/// In units of the filter's residual. Both legs of a blend pass the same filter, d samples apart. So a blend leaves the
/// residual times |v2 - v1 exp(-(z w + j wd) d T)|/wd. A start or stop leaves it times its speed over wd.
Interval CheckedRows::bound_of_mode(const proof::Vibration& row, const Mode& mode, const CheckedBox& box) const {
  if (!mode.of_axis()) {
    if (row.corner >= 0) throw Rejected("a multiplier sees a blend in a mode of the filter");
    return {mode.residual_max};
  }
  const auto a = static_cast<std::size_t>(mode.axis);
  const Interval z(row.damping), natural = two_pi() * Interval(row.frequency),
                                 damped = natural * square_root((Interval(1.0) - z) * (Interval(1.0) + z));
  Interval speed(std::max(bounds_.event_speed(a, false), bounds_.event_speed(a, true)));
  if (row.corner >= 0) {
    const TaskCorner& c = corner(row.corner);
    const int d = single_delay(row.corner, box);
    // The longest delay stands for all longer ones, where the phase is another.
    if (!c.delay && d >= task_.design.order_max + 2 + longer())
      throw Rejected("a multiplier names the phase of a delay that stands for many");
    const Interval in = checked_speed(c, a, true), out = checked_speed(c, a, false),
                   gap = period() * static_cast<double>(d);
    const Interval left = in * interval_exp(-1.0 * (natural * z * gap)), turn = damped * gap;
    const Interval along = (out - left * interval_cos(turn)).magnitude(),
                   across = (left * interval_sin(turn)).magnitude();
    speed = square_root(along * along + across * across);
  }
  if (!(speed.lo > 0.0)) throw Rejected("a multiplier names a mode that nothing excites");
  return Interval(mode.displacement_max) * damped / speed;
}

/// The speed in leg 2's direction does not fall. From the end of the range on it is above `still_part` of the feed, and
/// so not below 0. Before the range it is at most that part, widened as all limits are.
void CheckedRows::add_row(const proof::Reversal& row, const Interval& weight, CheckedBox& box, CheckedSum& sum) const {
  const TaskCorner& c = corner(row.corner);
  axis(row.axis);
  const int d = single_delay(row.corner, box);
  const auto a = static_cast<std::size_t>(row.axis);
  const Interval in = checked_speed(c, a, true), out = checked_speed(c, a, false);
  if (!((in * out).hi < 0.0)) throw Rejected("a multiplier names the reversal of an axis that keeps its direction");
  const CheckedReversal range = box.reversal(row.corner, row.axis);
  const bool after = row.sign > 0;
  if (after ? row.sample < range.last : row.sample >= range.first)
    throw Rejected("a multiplier names a sample at which an axis may reverse");
  const Interval scale =
      weight * (after == (out.lo > 0.0) ? -1.0 : 1.0) / Interval(std::max(c.geometry().feed_in, c.geometry().feed_out));
  sum.rhs = sum.rhs - scale * in;
  if (!after) sum.rhs = sum.rhs + weight * (2.0 * still_part);
  sum.response_behind(response_.motion(), row.sample, -1.0 * scale * in);
  sum.response_behind(response_.motion(), row.sample - d, scale * out);
}

void CheckedRows::add_row(const proof::Blend& row, const Interval& weight, CheckedBox& box, CheckedSum& sum) const {
  const int k = row.sample;
  const TaskCorner& c = corner(row.corner);
  const Axis& x = axis(row.axis);
  if (k < 1 || k > 100'000'000) throw Rejected("a multiplier names a sample that is not there");
  const std::optional<int> times = checked_differences(row.limit);
  const std::vector<Interval>& behind = times ? response_.command() : response_.motion();
  const int d = single_delay(row.corner, box);
  const auto a = static_cast<std::size_t>(row.axis);
  const Interval in = checked_speed(c, a, true), out = checked_speed(c, a, false);
  const Interval y = weight * (row.sign < 0 ? -1.0 : 1.0);
  const auto acceleration = [&](int at, const Interval& f) {
    sum.tap_behind(behind, at - 1, -1.0 * f * in / period());
    sum.tap_behind(behind, at - 1 - d, f * out / period());
  };
  if (times) {
    const double bound = x.*axis_limit(row.limit).bound;
    require_limit(bound);
    add_difference(*times, k, y / Interval(bound), Interval(1.0) / period(), acceleration);
  } else if (row.limit == LimitKind::force || row.limit == LimitKind::force_speed) {
    const CheckedForce force = row.limit == LimitKind::force ? largest_force(x) : checked_line(x, row.line);
    const Interval f = y / force.bound;
    const Interval drag =
        f * Interval(x.damping) + weight * (row.direction < 0 ? -1.0 : 1.0) * force.slope / force.bound;
    acceleration(k, f * Interval(x.mass));
    sum.rhs = sum.rhs - drag * in;
    // Dry friction is against the direction of the motion. An axis that reverses may have it help until it surely has.
    const bool reverses = (in * out).lo < 0.0, reversed = k >= box.reversal(row.corner, row.axis).last;
    const double forward = (reverses ? out : in + out).lo > 0.0 ? 1.0 : -1.0;
    const double help = reverses && !reversed ? 1.0 : -forward * (row.sign < 0 ? -1.0 : 1.0);
    sum.rhs = sum.rhs + weight * Interval(help * x.coulomb) / force.bound;
    sum.response_behind(behind, k, -1.0 * drag * in);
    sum.response_behind(behind, k - d, drag * out);
  } else {
    throw Rejected("a multiplier names a limit that blends have no rows of");
  }
  sum.rhs = sum.rhs + weight;
}

}  // namespace accdec
