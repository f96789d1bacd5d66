#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <accdec/exact/rows.hpp>

namespace accdec::exact {
namespace {

/// A row on its way: terms beyond the order are dropped, responses there are 1.
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

ConvexRows::ConvexRows(const Task& task)
    : task_(task), speeds_(event_speeds(task)), jerk_max_(std::numeric_limits<double>::infinity()) {
  const double t = task.sample_period;
  for (std::size_t a = 0; a < speeds_.size(); ++a) {
    const Axis& axis = task.machine.axes[a];
    const double fastest = std::max(speeds_[a].start, speeds_[a].stop);
    if (fastest == 0.0) continue;
    if (axis.acceleration_max < unlimited) tap_max_ = std::min(tap_max_, axis.acceleration_max * t / fastest);
    if (axis.jerk_max < unlimited) jerk_max_ = std::min(jerk_max_, axis.jerk_max * t * t / fastest);
    if (axis.force_max < unlimited && axis.damping == 0.0 && axis.mass > 0.0)
      tap_max_ = std::min(tap_max_, axis.force_max * t / (axis.mass * fastest));
  }
}

std::vector<proof::Row> ConvexRows::base_force_rows(int order) const {
  std::vector<proof::Row> rows;
  for (std::size_t a = 0; a < speeds_.size(); ++a) {
    const Axis& axis = task_.machine.axes[a];
    if (axis.force_max == unlimited || axis.damping == 0.0) continue;
    for (int k = 1; k <= order + 1; ++k) {
      if (speeds_[a].start > 0.0) rows.push_back(proof::EventForce{false, static_cast<int>(a), k});
      if (speeds_[a].stop > speeds_[a].start) rows.push_back(proof::EventForce{true, static_cast<int>(a), k});
    }
  }
  return rows;
}

SparseRow ConvexRows::row(const proof::TapDifference& id, const Box& box) const {
  RowBuilder b{box.order};
  b.tap(id.sample, id.sign / jerk_max_);
  b.tap(id.sample - 1, -id.sign / jerk_max_);
  return std::move(b.row);
}

SparseRow ConvexRows::row(const proof::EventForce& id, const Box& box) const {
  RowBuilder b{box.order};
  const Axis& axis = task_.machine.axes[static_cast<std::size_t>(id.axis)];
  const EventSpeeds& s = speeds_[static_cast<std::size_t>(id.axis)];
  const double scale = (id.stop ? s.stop : s.start) / axis.force_max;
  b.tap(id.sample - 1, scale * axis.mass / task_.sample_period);
  b.response(id.sample, scale * axis.damping);
  if (id.stop) b.row.constant -= scale * axis.damping;
  return std::move(b.row);
}

SparseRow ConvexRows::row(const proof::Blend& id, const Box& box) const {
  RowBuilder b{box.order};
  const double t = task_.sample_period;
  const Axis& axis = task_.machine.axes[static_cast<std::size_t>(id.axis)];
  const Legs v = legs(task_.corners[static_cast<std::size_t>(id.corner)], static_cast<std::size_t>(id.axis));
  const int d = box.corner(id.corner).d1, k = id.sample;
  const auto acceleration = [&](int at, double c) {
    b.tap(at - 1, -c * v.in / t);
    b.tap(at - 1 - d, c * v.out / t);
  };
  switch (id.limit) {
    case proof::BlendLimit::acceleration: acceleration(k, id.sign / axis.acceleration_max); break;
    case proof::BlendLimit::jerk:
      acceleration(k, id.sign / (t * axis.jerk_max));
      acceleration(k - 1, -id.sign / (t * axis.jerk_max));
      break;
    case proof::BlendLimit::force: {
      const double c = id.sign / axis.force_max;
      acceleration(k, c * axis.mass);
      b.row.constant += c * axis.damping * v.in;
      b.response(k, -c * axis.damping * v.in);
      b.response(k - d, c * axis.damping * v.out);
      break;
    }
  }
  return std::move(b.row);
}

std::vector<proof::Row> ConvexRows::broken_blend_rows(const Filter& filter, const Box& box, double slack) const {
  using proof::BlendLimit;
  std::vector<proof::Row> broken;
  const double t = task_.sample_period;
  for (std::size_t j = 0; j < box.corners.size(); ++j) {
    if (box.corners[j].d1 != box.corners[j].d2) continue;
    const int d = box.corners[j].d1;
    for (std::size_t a = 0; a < task_.machine.axes.size(); ++a) {
      const Axis& axis = task_.machine.axes[a];
      const Legs v = legs(task_.corners[j], a);
      if (v.in == 0.0 || v.out == 0.0) continue;
      double before = 0.0;
      for (int k = 1; k <= box.order + d + 2; ++k) {
        const double acc = (v.out * filter.tap(k - 1 - d) - v.in * filter.tap(k - 1)) / t;
        const auto test = [&](BlendLimit limit, double value, double bound) {
          if (!(std::abs(value) > bound * (1.0 + slack))) return;
          broken.push_back(proof::Blend{limit, static_cast<int>(j), static_cast<int>(a), k, value > 0.0 ? 1 : -1});
        };
        test(BlendLimit::acceleration, acc, axis.acceleration_max);
        test(BlendLimit::jerk, (acc - before) / t, axis.jerk_max);
        test(BlendLimit::force,
             axis.mass * acc + axis.damping * (v.in * filter.remaining(k) + v.out * filter.cumulative(k - d)),
             axis.force_max);
        before = acc;
      }
    }
  }
  return broken;
}

double ConvexRows::vibration_coefficient(const proof::Vibration& id, int i) const {
  return std::cos(2.0 * std::numbers::pi * id.frequency * task_.sample_period * i - id.angle);
}

}  // namespace accdec::exact
