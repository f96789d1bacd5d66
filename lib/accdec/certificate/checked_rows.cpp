#include <algorithm>
#include <cmath>
#include <optional>

#include <accdec/certificate/checked_rows.hpp>
#include <accdec/machine/limits.hpp>

namespace accdec {

void require_limit(double bound) {
  if (!(bound < unlimited)) throw Rejected("a multiplier names a limit that is not there");
}

namespace {

/// How often the acceleration is differenced over T to give the limited value: the checker's own list. None for other
/// limits. None: other limits.
std::optional<int> differences(LimitKind kind) {
  switch (kind) {
    case LimitKind::acceleration: return 0;
    case LimitKind::jerk: return 1;
    case LimitKind::velocity:
    case LimitKind::force:
    case LimitKind::power:
    case LimitKind::regeneration:
    case LimitKind::vibration:
    case LimitKind::corner_error:
    case LimitKind::speed_min:
    case LimitKind::power_total:
    case LimitKind::regeneration_total: break;
  }
  return std::nullopt;
}

/// Adds c times the n-th difference at `at` of the terms that `term` adds; every difference is multiplied by `step`.
template <class Term>
void add_difference(int n, int at, const Interval& c, const Interval& step, const Term& term) {
  if (n == 0) return term(at, c);
  add_difference(n - 1, at, c * step, step, term);
  add_difference(n - 1, at - 1, -1.0 * c * step, step, term);
}

/// Dry friction is against a start and helps a stop: what it adds to the force limit.
Interval friction_of_event(const Axis& axis, bool stop) {
  return Interval(stop ? axis.coulomb : -axis.coulomb);
}

/// Sine of the interior angle. For nearly collinear legs the cosine gives it only to some 1e-8. The part of leg 2
/// across leg 1 is more precise.
Interval sine_of(const Corner& corner, const Interval& cosine) {
  Interval sine = square_root((Interval(1.0) - cosine) * (Interval(1.0) + cosine));
  Interval across(0.0);
  for (Eigen::Index a = 0; a < corner.axes(); ++a) {
    const Interval part = Interval(corner.direction_out[a]) + cosine * Interval(corner.direction_in[a]);
    const Interval size = part.magnitude();
    across = across + size * size;
  }
  across = square_root(across);
  sine.lo = std::max(sine.lo, across.lo), sine.hi = std::min(sine.hi, across.hi);
  return sine;
}

}  // namespace

CheckedRows::CheckedRows(const Task& task) : task_(task), response_(task) {
  const Interval t(task.sample_period);
  for (std::size_t a = 0; a < task.machine.axes.size(); ++a) {
    const Axis& axis = task.machine.axes[a];
    double start = 0.0, stop = 0.0;
    for (const TaskCorner& c : task.corners) {
      // Lower ends: a slower leg needs less.
      const double in = speed(c, a, true).magnitude().lo, out = speed(c, a, false).magnitude().lo;
      start = std::max({start, in, in == 0.0 ? out : 0.0});
      stop = std::max({stop, out, out == 0.0 ? in : 0.0});
    }
    // Behind a response, loads are not those of the taps themselves.
    for (const bool ends : {false, true}) {
      if (!response_.ideal()) break;
      const Interval s(ends ? stop : start);
      if (s.lo == 0.0) continue;
      CheckedPlant p{Interval(axis.mass) / t, Interval(axis.damping), {}, {}, {}, ends};
      const auto over = [](double bound, const Interval& by) {
        return bound < unlimited ? Interval(bound) / by : Interval(bound);
      };
      p.force = over((Interval(axis.force_max) + friction_of_event(axis, ends)).hi, s);
      p.power = over(axis.power_max, s * s);
      // Without its dry friction a stop would brake more.
      p.regeneration = over(axis.coulomb > 0.0 ? unlimited : axis.regeneration_max, s * s);
      plants_.push_back(p);
    }
    start_.push_back(start);
    stop_.push_back(stop);
    const double fastest = std::max(start, stop);
    // Behind the control's smoothing, no limit is on the taps themselves.
    if (fastest == 0.0 || response_.smooths()) continue;
    if (axis.acceleration_max < unlimited)
      tap_max_ = std::min(tap_max_, (Interval(axis.acceleration_max) * t / fastest).hi);
    for (const AxisLimit& limit : axis_limits) {
      const double bound = axis.*limit.bound;
      if (differences(limit.kind).value_or(0) == 0 || !(bound < unlimited)) continue;
      Interval max = Interval(bound) * t / fastest;
      for (int n = *differences(limit.kind); n > 0; --n) max = max * t;
      double& known = ramp_max_.try_emplace(limit.kind, unlimited).first->second;
      known = std::min(known, max.hi);
    }
    if (response_.ideal() && axis.force_max < unlimited && axis.damping == 0.0 && axis.mass > 0.0) {
      for (const bool ends : {false, true}) {
        const Interval inertia = Interval(axis.mass) * (ends ? stop : start);
        if (inertia.lo > 0.0)
          tap_max_ = std::min(tap_max_, ((Interval(axis.force_max) + friction_of_event(axis, ends)) * t / inertia).hi);
      }
    }
  }
}

double CheckedRows::ramp_max(LimitKind kind) const {
  const auto found = ramp_max_.find(kind);
  return found == ramp_max_.end() ? unlimited : found->second;
}

Interval CheckedRows::speed(const TaskCorner& c, std::size_t axis, bool in) const {
  const auto a = static_cast<Eigen::Index>(axis);
  return in ? Interval(c.geometry().feed_in) * c.geometry().direction_in[a]
            : Interval(c.geometry().feed_out) * c.geometry().direction_out[a];
}

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
                  std::is_same_v<Row, proof::EventForce> || std::is_same_v<Row, proof::EventPower>) {
      if (sum.terms == terms && (sum.rhs - before).lo > 0.0) sum.rhs = before;
    }
  };
  std::visit(add, term.row);
}

void CheckedRows::require_inside(const proof::Row& row, const CheckedBox& box) const {
  const auto inside = [&](int tap) { return tap >= 1 && tap < box.order; };
  // The rest of a damped vibration depends on how far the filter's end is.
  const auto* vibration = std::get_if<proof::Vibration>(&row);
  bool all = std::holds_alternative<proof::Error>(row) || (vibration != nullptr && vibration->damping == 0.0);
  if (const auto* difference = std::get_if<proof::TapDifference>(&row))
    all = inside(difference->sample) && inside(difference->sample - differences(difference->limit).value_or(0));
  if (const auto* force = std::get_if<proof::EventForce>(&row)) all = inside(force->sample - 1);
  if (const auto* blend = std::get_if<proof::Blend>(&row)) {
    corner(blend->corner);
    const int d = single_delay(blend->corner, box), tap = blend->sample - 1;
    const int oldest = tap - differences(blend->limit).value_or(0);
    all = inside(tap) && inside(tap - d) && inside(oldest) && inside(oldest - d);
  }
  if (!all) throw Rejected("a multiplier names a limit beyond its window");
}

void CheckedRows::add_row(const proof::TapDifference& row, const Interval& weight, CheckedBox&, CheckedSum& sum) const {
  response_.require_no_smoothing();
  const int n = differences(row.limit).value_or(0);
  if (n == 0) throw Rejected("a multiplier names a difference that no limit bounds");
  const double max = ramp_max(row.limit);
  require_limit(max);
  if (row.sample < 0 || row.sample > sum.order() + n) return;
  const Interval c = weight * (row.sign < 0 ? -1.0 : 1.0) / Interval(max);
  add_difference(n, row.sample, c, Interval(1.0), [&](int i, const Interval& f) { sum.tap(i, f); });
  sum.rhs = sum.rhs + weight;
}

void CheckedRows::add_row(const proof::EventForce& row, const Interval& weight, CheckedBox&, CheckedSum& sum) const {
  response_.require_ideal();
  const int k = row.sample;
  if (k < 1 || k > static_cast<int>(sum.taps.size())) return;
  const Axis& x = axis(row.axis);
  require_limit(x.force_max);
  const double speed = (row.stop ? stop_ : start_)[static_cast<std::size_t>(row.axis)];
  const Interval scale = weight * speed / Interval(x.force_max);
  sum.tap(k - 1, scale * Interval(x.mass) / period());
  sum.response(k, scale * Interval(x.damping));
  sum.rhs = sum.rhs + weight;
  if (row.stop) sum.rhs = sum.rhs + scale * Interval(x.damping);
  sum.rhs = sum.rhs + weight * friction_of_event(x, row.stop) / Interval(x.force_max);
}

void CheckedRows::add_row(const proof::Error& row, const Interval& weight, CheckedBox& box, CheckedSum& sum) const {
  const TaskCorner& c = corner(row.corner);
  if (!c.error_max) throw Rejected("a multiplier names a limit that is not there");
  const CheckedRange& r = box.corners[static_cast<std::size_t>(row.corner)];
  const Interval cosine(std::nextafter(c.geometry().cos_interior(), -2.0),
                        std::nextafter(c.geometry().cos_interior(), 2.0));
  const Interval sine = sine_of(c.geometry(), cosine);
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

void CheckedRows::add_row(const proof::Vibration& row, const Interval& weight, CheckedBox& box, CheckedSum& sum) const {
  if (row.mode < 0 || row.mode >= static_cast<int>(task_.machine.modes.size()))
    throw Rejected("a multiplier names a mode that is not there");
  const Mode& mode = task_.machine.modes[static_cast<std::size_t>(row.mode)];
  response_.require_no_smoothing();
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
  for (std::size_t i = sum.taps.size(); i-- > 0;) {
    // The taps that an end of the window stands for may have any phase.
    const bool end = box.window && (i == 0 || i + 1 == sum.taps.size());
    const Interval phase = end ? Interval(-1.0) : interval_cos(w * static_cast<double>(i) - Interval(row.angle));
    sum.taps[i] = sum.taps[i] + fallen * phase;
    if (damped) fallen = fallen * fall;
  }
  sum.rhs = sum.rhs + weight * Interval(mode.residual_max);
}

void CheckedRows::add_row(const proof::Blend& row, const Interval& weight, CheckedBox& box, CheckedSum& sum) const {
  const int k = row.sample;
  const TaskCorner& c = corner(row.corner);
  const Axis& x = axis(row.axis);
  if (k < 1 || k > 100'000'000) throw Rejected("a multiplier names a sample that is not there");
  response_.require_no_smoothing();
  if (row.limit == LimitKind::force) response_.require_ideal();
  const int d = single_delay(row.corner, box);
  const auto a = static_cast<std::size_t>(row.axis);
  const Interval in = speed(c, a, true), out = speed(c, a, false);
  const Interval y = weight * (row.sign < 0 ? -1.0 : 1.0);
  const auto acceleration = [&](int at, const Interval& f) {
    sum.tap(at - 1, -1.0 * f * in / period());
    sum.tap(at - 1 - d, f * out / period());
  };
  if (const std::optional<int> times = differences(row.limit)) {
    const double bound = x.*axis_limit(row.limit).bound;
    require_limit(bound);
    add_difference(*times, k, y / Interval(bound), Interval(1.0) / period(), acceleration);
  } else if (row.limit == LimitKind::force) {
    require_limit(x.force_max);
    const Interval f = y / Interval(x.force_max), drag = f * Interval(x.damping);
    acceleration(k, f * Interval(x.mass));
    sum.rhs = sum.rhs - drag * in;
    // Dry friction is against an axis that keeps its direction. One that reverses may have it help at every sample.
    const double forward = in.lo + out.lo > 0.0 ? 1.0 : -1.0;
    const double help = (in * out).lo < 0.0 ? 1.0 : -forward * (row.sign < 0 ? -1.0 : 1.0);
    sum.rhs = sum.rhs + weight * Interval(help * x.coulomb) / Interval(x.force_max);
    sum.response(k, -1.0 * drag * in);
    sum.response(k - d, drag * out);
  } else {
    throw Rejected("a multiplier names a limit that blends have no rows of");
  }
  sum.rhs = sum.rhs + weight;
}

}  // namespace accdec
