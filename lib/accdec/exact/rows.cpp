#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <optional>
#include <utility>

#include <accdec/exact/rows.hpp>

namespace accdec::exact {
namespace {

/// A row under construction: terms beyond the order are dropped, as responses there are 1. In a window there may be
/// taps before and after all of them.
struct RowBuilder {
  int order;
  bool all = false;
  SparseRow row{};
  void tap(int i, double c) {
    if (all || (i >= 0 && i <= order)) row.taps.emplace_back(i, c);
  }
  void response(int k, double c) {  // c B_k
    if (k > order && !all)
      row.constant += c;
    else if (k > 0 || all)
      row.sums.emplace_back(k, c);
  }
};

}  // namespace

double friction_help(const Axis& axis, const Legs& v, int sign, bool reversed) {
  if (axis.coulomb == 0.0) return 0.0;
  const bool reverses = v.in * v.out < 0.0;
  if (reverses && !reversed) return axis.coulomb;
  const double along = reverses ? v.out : v.in + v.out;
  return along > 0.0 ? -sign * axis.coulomb : sign * axis.coulomb;
}

Legs legs(const TaskCorner& corner, std::size_t axis) {
  const auto a = static_cast<Eigen::Index>(axis);
  return {corner.geometry().feed_in * corner.geometry().direction_in[a],
          corner.geometry().feed_out * corner.geometry().direction_out[a]};
}

std::vector<EventSpeeds> event_speeds(const Task& task) {
  std::vector<EventSpeeds> speeds;
  for (std::size_t a = 0; a < task.machine.axes.size(); ++a) {
    EventSpeeds s;
    for (const TaskCorner& corner : task.corners) {
      const Legs v = legs(corner, a);
      const double in = std::abs(v.in), out = std::abs(v.out);
      s.start = std::max({s.start, in, in == 0.0 ? out : 0.0});
      s.stop = std::max({s.stop, out, out == 0.0 ? in : 0.0});
    }
    speeds.push_back(s);
  }
  return speeds;
}

ConvexRows::ConvexRows(const Task& task)
    : task_(task),
      smoothing_(Smoothing::of_command(task.machine)),
      motion_(Smoothing::of_motion(task.machine, task.sample_period)),
      speeds_(event_speeds(task)) {
  for (const Axis& axis : task.machine.axes) lines_.push_back(force_lines(axis));
  const double t = task.sample_period;
  for (std::size_t n = 0; n < period_to_the_.size(); ++n) period_to_the_[n] = std::pow(t, static_cast<double>(n));
  for (std::size_t a = 0; a < speeds_.size(); ++a) {
    const Axis& axis = task.machine.axes[a];
    const double fastest = std::max(speeds_[a].start, speeds_[a].stop);
    if (fastest == 0.0) continue;
    if (axis.acceleration_max < unlimited) tap_max_ = std::min(tap_max_, axis.acceleration_max * t / fastest);
    if (axis.force_max == unlimited || axis.damping > 0.0 || axis.mass == 0.0 || !motion_.none()) continue;
    // Dry friction is against a start and helps a stop.
    if (speeds_[a].start > 0.0)
      tap_max_ = std::min(tap_max_, (axis.force_max - axis.coulomb) * t / (axis.mass * speeds_[a].start));
    if (speeds_[a].stop > 0.0)
      tap_max_ = std::min(tap_max_, (axis.force_max + axis.coulomb) * t / (axis.mass * speeds_[a].stop));
  }
  command_tap_max_ = tap_max_;
  tap_max_ = std::min(1.0, tap_max_ / smoothing_.largest());
  for (const AxisLimit& limit : axis_limits) {
    if (limit.differences < (smoothing_.none() ? 1 : 0)) continue;
    RampLimit ramp{limit.kind, limit.differences, unlimited};
    for (std::size_t a = 0; a < speeds_.size(); ++a) {
      const double fastest = std::max(speeds_[a].start, speeds_[a].stop), bound = task.machine.axes[a].*limit.bound;
      if (fastest > 0.0 && bound < unlimited)
        ramp.max = std::min(ramp.max, bound * std::pow(t, limit.differences + 1) / fastest);
    }
    if (ramp.max < unlimited) ramps_.push_back(ramp);
  }
}

double ConvexRows::ramp_max(LimitKind kind) const {
  for (const RampLimit& ramp : ramps_) {
    if (ramp.kind == kind) return ramp.max;
  }
  return unlimited;
}

std::vector<proof::Row> ConvexRows::base_force_rows(int order) const {
  std::vector<proof::Row> rows;
  for (std::size_t a = 0; a < speeds_.size() && !servo(); ++a) {
    const Axis& axis = task_.machine.axes[a];
    if (axis.force_max == unlimited || (axis.damping == 0.0 && smoothing_.none())) continue;
    for (int k = 1; k <= order + smoothing_.order() + 1; ++k) {
      if (speeds_[a].start > 0.0) rows.push_back(proof::EventForce{false, static_cast<int>(a), k});
      if (speeds_[a].stop > speeds_[a].start) rows.push_back(proof::EventForce{true, static_cast<int>(a), k});
    }
  }
  return rows;
}

SparseRow ConvexRows::row(const proof::TapDifference& id, const Box& box) const {
  RowBuilder b{box.order + smoothing_.order()};
  const int n = axis_limit(id.limit).differences;
  const double bound = ramp_max(id.limit);
  for (int j = 0; j <= n; ++j) b.tap(id.sample - j, id.sign * difference_weight(n, j) / bound);
  return std::move(b.row);
}

SparseRow ConvexRows::row(const proof::EventForce& id, const Box& box) const {
  RowBuilder b{box.order + motion_.order(), box.window && servo()};
  b.row.of_motion = servo();
  const Axis& axis = task_.machine.axes[static_cast<std::size_t>(id.axis)];
  const EventSpeeds& s = speeds_[static_cast<std::size_t>(id.axis)];
  // A stop brakes: its force points against its speed.
  const ForceRow force = force_row(id.axis, id.line, id.stop ? -1.0 : 1.0, 1.0);
  const double scale = (id.stop ? s.stop : s.start) / force.bound, drag = id.stop ? -force.drag : force.drag;
  b.tap(id.sample - 1, scale * axis.mass / task_.sample_period);
  b.response(id.sample, scale * drag);
  if (id.stop) b.row.constant -= scale * drag;
  b.row.constant += (id.stop ? -axis.coulomb : axis.coulomb) / force.bound;
  return std::move(b.row);
}

SparseRow ConvexRows::row(const proof::Blend& id, const Box& box) const {
  const bool loads = id.limit == LimitKind::force || id.limit == LimitKind::force_speed;
  RowBuilder b{box.order + (loads ? motion_ : smoothing_).order(), box.window && loads && servo()};
  b.row.of_motion = loads && servo();
  const double t = task_.sample_period;
  const Axis& axis = task_.machine.axes[static_cast<std::size_t>(id.axis)];
  const Legs v = legs(task_.corners[static_cast<std::size_t>(id.corner)], static_cast<std::size_t>(id.axis));
  const int d = box.corner(id.corner).d1, k = id.sample;
  const auto acceleration = [&](int at, double c) {
    b.tap(at - 1, -c * v.in / t);
    b.tap(at - 1 - d, c * v.out / t);
  };
  if (loads) {
    const ForceRow force = force_row(id.axis, id.limit == LimitKind::force ? -1 : id.line, id.sign, id.direction);
    acceleration(k, id.sign * axis.mass / force.bound);
    const bool reversed = k >= box.reversal(id.corner, id.axis).last;
    b.row.constant += (force.drag * v.in - friction_help(axis, v, id.sign, reversed)) / force.bound;
    b.response(k, -force.drag * v.in / force.bound);
    b.response(k - d, force.drag * v.out / force.bound);
    return std::move(b.row);
  }
  const AxisLimit& limit = axis_limit(id.limit);
  const double bound = period_to_the_[static_cast<std::size_t>(limit.differences)] * axis.*limit.bound;
  for (int j = 0; j <= limit.differences; ++j)
    acceleration(k - j, id.sign * difference_weight(limit.differences, j) / bound);
  return std::move(b.row);
}

/// The speed in leg 2's direction, in parts of the faster feed: not below 0, or not above 0.
SparseRow ConvexRows::row(const proof::Reversal& id, const Box& box) const {
  RowBuilder b{box.order + motion_.order()};
  b.row.of_motion = servo();
  const TaskCorner& corner = task_.corners[static_cast<std::size_t>(id.corner)];
  const Legs v = legs(corner, static_cast<std::size_t>(id.axis));
  const double c = (v.out > 0.0 ? -id.sign : id.sign) / std::max(corner.geometry().feed_in, corner.geometry().feed_out);
  b.row.constant += 1.0 + c * v.in;
  b.response(id.sample, -c * v.in);
  b.response(id.sample - box.corner(id.corner).d1, c * v.out);
  return std::move(b.row);
}

/// sign (m a + c v) + slope direction v <= bound: as a force of one sign whose friction is `drag`.
ConvexRows::ForceRow ConvexRows::force_row(int a, int line, double sign, double direction) const {
  const Axis& axis = task_.machine.axes[static_cast<std::size_t>(a)];
  if (line < 0) return {axis.force_max, sign * axis.damping};
  const ForceLine& of = lines_[static_cast<std::size_t>(a)][static_cast<std::size_t>(line)];
  return {of.force, sign * axis.damping + direction * of.slope};
}

void ConvexRows::add_motion(const SparseRow& row, double factor, bool window, std::span<double> designed) const {
  const int last = static_cast<int>(designed.size()) - 1;
  const auto add = [&](int i, const auto& of_tap, const auto& of_sum) {
    double sum = 0.0;
    for (const auto& [n, c] : row.taps) sum += of_tap(n - i, c);
    for (const auto& [k, c] : row.sums) sum += of_sum(k - i, c);
    designed[static_cast<std::size_t>(i)] += factor * sum;
  };
  for (int i = window ? 1 : 0; i <= (window ? last - 1 : last); ++i) {
    add(
        i, [&](int after, double c) { return c * motion_.tap(after); },
        [&](int after, double c) { return c * motion_.sum(after); });
  }
  if (!window) return;
  add(
      0, [&](int after, double c) { return std::min(0.0, c) * motion_.largest(after, motion_.order()); },
      [&](int after, double c) { return std::min(c * motion_.sum(after), c); });
  add(
      last, [&](int after, double c) { return std::min(0.0, c) * motion_.largest(0, after); },
      [&](int after, double c) { return std::min(0.0, c) * motion_.sum(after); });
}

void ConvexRows::add(const SparseRow& row, double factor, bool window, WeightedTaps& sum) const {
  if (row.of_motion) return add_motion(row, factor, window, sum.designed());
  for (const auto& [i, c] : row.taps) sum.command()[static_cast<std::size_t>(i)] += factor * c;
  for (const auto& [k, c] : row.sums) sum.add_response(k, factor * c);
}

double ConvexRows::vibration_bound(const proof::Vibration& id) const {
  const Mode& mode = task_.machine.modes[static_cast<std::size_t>(id.mode)];
  if (!mode.of_axis()) return mode.residual_max;
  const EventSpeeds& s = speeds_[static_cast<std::size_t>(mode.axis)];
  const double damped = 2.0 * std::numbers::pi * id.frequency * std::sqrt((1.0 - id.damping) * (1.0 + id.damping));
  const double fastest = std::max(s.start, s.stop);
  return fastest > 0.0 ? mode.displacement_max * damped / fastest : infinity;
}

double ConvexRows::vibration_bound(const proof::Vibration& id, const Box& box) const {
  if (id.corner < 0) return vibration_bound(id);
  const Mode& mode = task_.machine.modes[static_cast<std::size_t>(id.mode)];
  const CornerBox& c = box.corner(id.corner);
  const TaskCorner& corner = task_.corners[static_cast<std::size_t>(id.corner)];
  if (c.d1 < c.d2 || (!corner.delay && c.d1 >= task_.design.order_max + settling + box.longer())) return infinity;
  const Legs v = legs(corner, static_cast<std::size_t>(mode.axis));
  const double natural = 2.0 * std::numbers::pi * id.frequency, gap = c.d1 * task_.sample_period;
  const double damped = natural * std::sqrt((1.0 - id.damping) * (1.0 + id.damping));
  // Both legs excite the mode through the same filter, the first one earlier.
  const double speed = std::abs(v.out - v.in * std::polar(std::exp(-id.damping * natural * gap), damped * gap));
  return speed > 0.0 ? mode.displacement_max * damped / speed : infinity;
}

bool ConvexRows::breaks_residual(const Filter& filter, const Box& box, std::size_t corner, double slack) const {
  std::optional<Filter> made;
  const Filter& command = smoothing_.behind(filter, made);
  for (const Mode& mode : task_.machine.modes) {
    if (!mode.of_axis()) continue;
    const Legs v = legs(task_.corners[corner], static_cast<std::size_t>(mode.axis));
    const int delay = box.corners[corner].d1;
    if (v.in == 0.0 || v.out == 0.0) continue;
    if (residual_utilisation(command, v.in, v.out, delay, task_.sample_period, mode).utilisation > 1.0 + slack)
      return true;
  }
  return false;
}

void ConvexRows::add_vibration(const proof::Vibration& id, double y, std::span<double> taps) const {
  // The cosine is the expensive part. So it is advanced by rotation and computed directly now and then, before rounding
  // adds up. A damped vibration falls from every tap to the last.
  constexpr std::size_t afresh = 16;
  const double natural = 2.0 * std::numbers::pi * id.frequency * task_.sample_period;
  const double turn = natural * std::sqrt((1.0 - id.damping) * (1.0 + id.damping)), decay = id.damping * natural;
  const double fall = std::exp(-decay), c = fall * std::cos(turn), s = fall * std::sin(turn);
  double x = 0.0, z = 0.0;
  for (std::size_t i = taps.size(); i-- > 0;) {
    const std::size_t before_last = taps.size() - 1 - i;
    if (before_last % afresh == 0) {
      const double at = turn * static_cast<double>(i) - id.angle;
      const double left = std::exp(-decay * static_cast<double>(before_last));
      x = left * std::cos(at), z = left * std::sin(at);
    } else {
      const double after = x;
      x = c * after + s * z;
      z = c * z - s * after;
    }
    taps[i] += y * x;
  }
}

}  // namespace accdec::exact
