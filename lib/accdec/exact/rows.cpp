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

/// A row under construction: terms beyond the order are dropped, as responses there are 1.
struct RowBuilder {
  int order;
  SparseRow row{};
  void tap(int i, double c) {
    if (i >= 0 && i <= order) row.taps.emplace_back(i, c);
  }
  void response(int k, double c) {  // c B_k
    if (k > order)
      row.constant += c;
    else if (k > 0)
      row.sums.emplace_back(k, c);
  }
};

/// How much dry friction takes from a force to one side, N, while two legs meet. An axis that keeps its direction has
/// friction against it. One that reverses pushes to leg 2's side all the time. Before it moves there, friction helps.
double friction_help(const Axis& axis, const Legs& v, int sign, bool reversed) {
  if (axis.coulomb == 0.0) return 0.0;
  const bool reverses = v.in * v.out < 0.0;
  if (reverses && !reversed) return axis.coulomb;
  const double along = reverses ? v.out : v.in + v.out;
  return along > 0.0 ? -sign * axis.coulomb : sign * axis.coulomb;
}

}  // namespace

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

ConvexRows::ConvexRows(const Task& task) : task_(task), smoothing_(task.machine), speeds_(event_speeds(task)) {
  for (const Axis& axis : task.machine.axes) lines_.push_back(force_lines(axis));
  const double t = task.sample_period;
  for (std::size_t n = 0; n < period_to_the_.size(); ++n) period_to_the_[n] = std::pow(t, static_cast<double>(n));
  for (std::size_t a = 0; a < speeds_.size(); ++a) {
    const Axis& axis = task.machine.axes[a];
    const double fastest = std::max(speeds_[a].start, speeds_[a].stop);
    if (fastest == 0.0) continue;
    if (axis.acceleration_max < unlimited) tap_max_ = std::min(tap_max_, axis.acceleration_max * t / fastest);
    if (axis.force_max == unlimited || axis.damping > 0.0 || axis.mass == 0.0 || !smoothing_.none()) continue;
    // Dry friction is against a start and helps a stop.
    if (speeds_[a].start > 0.0)
      tap_max_ = std::min(tap_max_, (axis.force_max - axis.coulomb) * t / (axis.mass * speeds_[a].start));
    if (speeds_[a].stop > 0.0)
      tap_max_ = std::min(tap_max_, (axis.force_max + axis.coulomb) * t / (axis.mass * speeds_[a].stop));
  }
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
  for (std::size_t a = 0; a < speeds_.size(); ++a) {
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
  RowBuilder b{box.order + smoothing_.order()};
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
  RowBuilder b{box.order + smoothing_.order()};
  const double t = task_.sample_period;
  const Axis& axis = task_.machine.axes[static_cast<std::size_t>(id.axis)];
  const Legs v = legs(task_.corners[static_cast<std::size_t>(id.corner)], static_cast<std::size_t>(id.axis));
  const int d = box.corner(id.corner).d1, k = id.sample;
  const auto acceleration = [&](int at, double c) {
    b.tap(at - 1, -c * v.in / t);
    b.tap(at - 1 - d, c * v.out / t);
  };
  if (id.limit == LimitKind::force || id.limit == LimitKind::force_speed) {
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
  RowBuilder b{box.order + smoothing_.order()};
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

void ConvexRows::add_broken_event_forces(const Filter& command, std::size_t a, double slack,
                                         std::vector<proof::Row>& out) const {
  const Axis& axis = task_.machine.axes[a];
  for (int line = 0; line < static_cast<int>(lines_[a].size()); ++line) {
    const ForceLine& of = lines_[a][static_cast<std::size_t>(line)];
    for (int k = 1; k <= command.order() + 1; ++k) {
      const double inertia = axis.mass * command.tap(k - 1) / task_.sample_period;
      const double start = speeds_[a].start * (inertia + (axis.damping + of.slope) * command.cumulative(k));
      const double stop = speeds_[a].stop * (inertia + (of.slope - axis.damping) * command.remaining(k));
      if (speeds_[a].start > 0.0 && start + axis.coulomb > of.force * (1.0 + slack))
        out.push_back(proof::EventForce{false, static_cast<int>(a), k, line});
      if (speeds_[a].stop > 0.0 && stop - axis.coulomb > of.force * (1.0 + slack))
        out.push_back(proof::EventForce{true, static_cast<int>(a), k, line});
    }
  }
}

void ConvexRows::add_broken_reversals(const Filter& command, const Box& box, double slack,
                                      std::vector<proof::Row>& out) const {
  for (const ReversalRange& range : box.reversals) {
    const CornerBox& c = box.corner(range.corner);
    if (c.d1 != c.d2) continue;
    for (const proof::Reversal& id : {proof::Reversal{range.corner, range.axis, range.first - 1, -1},
                                      proof::Reversal{range.corner, range.axis, range.last, 1}}) {
      const SparseRow reversal = row(id, box);
      double value = reversal.constant;
      for (const auto& [k, coefficient] : reversal.sums) value += coefficient * command.cumulative(k);
      if (value > 1.0 + slack) out.push_back(id);
    }
  }
}

void ConvexRows::add_broken_curve(const Filter& command, const Box& box, std::size_t j, std::size_t a, double slack,
                                  std::vector<proof::Row>& out) const {
  const Axis& axis = task_.machine.axes[a];
  const Legs v = legs(task_.corners[j], a);
  const int d = box.corners[j].d1;
  for (int k = 1; k <= box.order + smoothing_.order() + d + 1 && !lines_[a].empty(); ++k) {
    const double speed = v.in * command.remaining(k) + v.out * command.cumulative(k - d);
    const double force =
        axis.mass * (v.out * command.tap(k - 1 - d) - v.in * command.tap(k - 1)) / task_.sample_period +
        axis.damping * speed;
    const int direction = speed < 0.0 ? -1 : 1;
    const bool reversed = k >= box.reversal(static_cast<int>(j), static_cast<int>(a)).last;
    for (const int sign : {1, -1}) {
      for (int line = 0; line < static_cast<int>(lines_[a].size()); ++line) {
        const ForceLine& of = lines_[a][static_cast<std::size_t>(line)];
        if (sign * force + of.slope * std::abs(speed) >
            (of.force + friction_help(axis, v, sign, reversed)) * (1.0 + slack))
          out.push_back(
              proof::Blend{LimitKind::force_speed, static_cast<int>(j), static_cast<int>(a), k, sign, line, direction});
      }
    }
  }
}

std::vector<proof::Row> ConvexRows::broken_blend_rows(const Filter& filter, const Box& box, double slack) const {
  std::vector<proof::Row> broken;
  std::optional<Filter> made;
  const Filter& command = smoothing_.command(filter, made);
  const double t = task_.sample_period;
  for (std::size_t a = 0; a < lines_.size(); ++a) add_broken_event_forces(command, a, slack, broken);
  add_broken_reversals(command, box, slack, broken);
  for (std::size_t j = 0; j < box.corners.size(); ++j) {
    if (box.corners[j].d1 != box.corners[j].d2) continue;
    const int d = box.corners[j].d1;
    for (std::size_t a = 0; a < task_.machine.axes.size(); ++a) {
      const Axis& axis = task_.machine.axes[a];
      const Legs v = legs(task_.corners[j], a);
      if (v.in == 0.0 || v.out == 0.0) continue;
      add_broken_curve(command, box, j, a, slack, broken);
      std::vector<const AxisLimit*> bounded;  // each difference that is computed costs time at every sample
      for (const AxisLimit& limit : axis_limits)
        if (limit.differences >= 0 && axis.*limit.bound < unlimited) bounded.push_back(&limit);
      const bool forced = axis.force_max < unlimited;
      const int reversed = box.reversal(static_cast<int>(j), static_cast<int>(a)).last;
      std::size_t used = forced ? 1 : 0;
      for (const AxisLimit* limit : bounded) used = std::max(used, static_cast<std::size_t>(limit->differences) + 1);
      std::array<double, most_differences + 1> difference{};  // of the acceleration, over T each time
      for (int k = 1; k <= box.order + smoothing_.order() + d + 1 + most_differences; ++k) {
        double next = (v.out * command.tap(k - 1 - d) - v.in * command.tap(k - 1)) / t;
        for (std::size_t i = 0; i < used; ++i) next = (next - std::exchange(difference[i], next)) / t;
        const auto test = [&](LimitKind limit, double value, double bound) {
          if (!(std::abs(value) > bound * (1.0 + slack))) return;
          broken.push_back(proof::Blend{limit, static_cast<int>(j), static_cast<int>(a), k, value > 0.0 ? 1 : -1});
        };
        for (const AxisLimit* limit : bounded)
          test(limit->kind, difference[static_cast<std::size_t>(limit->differences)], axis.*(limit->bound));
        if (!forced) continue;
        const double force = axis.mass * difference[0] +
                             axis.damping * (v.in * command.remaining(k) + v.out * command.cumulative(k - d));
        test(LimitKind::force, force, axis.force_max + friction_help(axis, v, force > 0.0 ? 1 : -1, k >= reversed));
      }
    }
  }
  return broken;
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
  const Filter& command = smoothing_.command(filter, made);
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
