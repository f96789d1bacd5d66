#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <accdec/exact/range_cut.hpp>
#include <accdec/exact/rows.hpp>
#include <accdec/task/objective.hpp>
#include <accdec/task/verifier.hpp>

namespace accdec::exact {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

}  // namespace

Legs legs(const TaskCorner& corner, std::size_t axis) {
  const auto a = static_cast<Eigen::Index>(axis);
  return {corner.geometry().feed_in * corner.geometry().direction_in[a],
          corner.geometry().feed_out * corner.geometry().direction_out[a]};
}

LimitModel::LimitModel(const Task& task) : task_(task), jerk_max_(infinity) {
  const double t = task.sample_period;
  for (std::size_t a = 0; a < task.machine.axes.size(); ++a) {
    const Axis& axis = task.machine.axes[a];
    Speeds s;
    for (const TaskCorner& corner : task.corners) {
      const Legs v = legs(corner, a);
      const double in = std::abs(v.in), out = std::abs(v.out);
      s.start = std::max({s.start, in, in == 0.0 ? out : 0.0});
      s.stop = std::max({s.stop, out, out == 0.0 ? in : 0.0});
    }
    speeds_.push_back(s);
    const double fastest = std::max(s.start, s.stop);
    if (fastest == 0.0) continue;
    if (axis.acceleration_max < unlimited) tap_max_ = std::min(tap_max_, axis.acceleration_max * t / fastest);
    if (axis.jerk_max < unlimited) jerk_max_ = std::min(jerk_max_, axis.jerk_max * t * t / fastest);
    if (axis.force_max == unlimited) continue;
    if (axis.damping > 0.0) has_sums_ = true;
    if (axis.damping == 0.0 && axis.mass > 0.0)
      tap_max_ = std::min(tap_max_, axis.force_max * t / (axis.mass * fastest));
  }
  find_families();
  if (!convex()) has_sums_ = true;
}

double LimitModel::error_bound(std::size_t corner) const {
  const TaskCorner& c = task_.corners[corner];
  // A little less than what simulation takes for zero, so that its own rounding does not matter.
  return std::max(*c.error_max, 0.999 * position_floor) /
         (task_.sample_period * std::max(c.geometry().feed_in, c.geometry().feed_out));
}

double LimitModel::theta(std::size_t corner) const {
  const double c = cos_interior(corner);
  return std::atan2(std::sqrt(std::max(0.0, (1.0 - c) * (1.0 + c))), c);
}
double LimitModel::scale_in(std::size_t j) const {
  const Corner& c = task_.corners[j].geometry();
  return c.feed_in / std::max(c.feed_in, c.feed_out);
}
double LimitModel::scale_out(std::size_t j) const {
  const Corner& c = task_.corners[j].geometry();
  return c.feed_out / std::max(c.feed_in, c.feed_out);
}

double LimitModel::weight_in(std::size_t corner, double angle) const {
  return scale_in(corner) * std::cos(angle);
}
double LimitModel::weight_out(std::size_t corner, double angle) const {
  const double c = cos_interior(corner);
  return scale_out(corner) * (c * std::cos(angle) + std::sqrt(std::max(0.0, (1.0 - c) * (1.0 + c))) * std::sin(angle));
}

std::vector<RowId> LimitModel::base_force_rows(int order) const {
  std::vector<RowId> rows;
  for (std::size_t a = 0; a < task_.machine.axes.size(); ++a) {
    const Axis& axis = task_.machine.axes[a];
    if (axis.force_max == unlimited || axis.damping == 0.0) continue;
    for (int k = 1; k <= order + 1; ++k) {
      RowId id;
      id.axis = static_cast<int>(a);
      id.sample = k;
      id.kind = RowKind::force_start;
      if (speeds_[a].start > 0.0) rows.push_back(id);
      id.kind = RowKind::force_stop;
      if (speeds_[a].stop > speeds_[a].start) rows.push_back(id);
    }
  }
  return rows;
}

SparseRow LimitModel::row(const RowId& id, const Box& box) const {
  SparseRow row;
  const double t = task_.sample_period;
  const auto tap = [&](int i, double c) {
    if (i >= 0 && i <= box.order) row.taps.emplace_back(i, c);
  };
  const auto sum = [&](int k, double c) {  // c B_k
    if (k > box.order)
      row.constant += c;
    else if (k > 0)
      row.sums.emplace_back(k, c);
  };
  if (id.kind >= RowKind::power_start) return chord_row(id, box);
  if (id.kind == RowKind::jerk) {
    tap(id.sample, id.sign / jerk_max_);
    tap(id.sample - 1, -id.sign / jerk_max_);
    return row;
  }
  const Axis& axis = task_.machine.axes[static_cast<std::size_t>(id.axis)];
  const int k = id.sample;
  if (id.kind == RowKind::force_start || id.kind == RowKind::force_stop) {
    const bool start = id.kind == RowKind::force_start;
    const Speeds& s = speeds_[static_cast<std::size_t>(id.axis)];
    const double scale = (start ? s.start : s.stop) / axis.force_max;
    tap(k - 1, scale * axis.mass / t);
    sum(k, scale * axis.damping);
    if (!start) row.constant -= scale * axis.damping;
    return row;
  }
  const Legs v = legs(task_.corners[static_cast<std::size_t>(id.corner)], static_cast<std::size_t>(id.axis));
  const int d = box.corners[static_cast<std::size_t>(id.corner)].d1;
  const auto acceleration = [&](int at, double c) {
    tap(at - 1, -c * v.in / t);
    tap(at - 1 - d, c * v.out / t);
  };
  if (id.kind == RowKind::blend_acceleration) {
    acceleration(k, id.sign / axis.acceleration_max);
  } else if (id.kind == RowKind::blend_jerk) {
    acceleration(k, id.sign / (t * axis.jerk_max));
    acceleration(k - 1, -id.sign / (t * axis.jerk_max));
  } else {
    const double c = id.sign / axis.force_max;
    acceleration(k, c * axis.mass);
    row.constant += c * axis.damping * v.in;
    sum(k, -c * axis.damping * v.in);
    sum(k - d, c * axis.damping * v.out);
  }
  return row;
}

std::vector<RowId> LimitModel::broken_blend_rows(const Filter& filter, const Box& box, double slack) const {
  std::vector<RowId> broken;
  const double t = task_.sample_period;
  for (std::size_t j = 0; j < corners(); ++j) {
    if (box.corners[j].d1 != box.corners[j].d2) continue;
    const int d = box.corners[j].d1;
    for (std::size_t a = 0; a < task_.machine.axes.size(); ++a) {
      const Axis& axis = task_.machine.axes[a];
      const Legs v = legs(task_.corners[j], a);
      if (v.in == 0.0 || v.out == 0.0) continue;
      double before = 0.0;
      for (int k = 1; k <= box.order + d + 2; ++k) {
        const double acc = (v.out * filter.tap(k - 1 - d) - v.in * filter.tap(k - 1)) / t;
        const auto test = [&](RowKind kind, double value, double bound) {
          if (!(std::abs(value) > bound * (1.0 + slack))) return;
          RowId id;
          id.kind = kind;
          id.sign = value > 0.0 ? 1 : -1;
          id.axis = static_cast<int>(a);
          id.corner = static_cast<int>(j);
          id.sample = k;
          broken.push_back(id);
        };
        test(RowKind::blend_acceleration, acc, axis.acceleration_max);
        test(RowKind::blend_jerk, (acc - before) / t, axis.jerk_max);
        test(RowKind::blend_force,
             axis.mass * acc + axis.damping * (v.in * filter.remaining(k) + v.out * filter.cumulative(k - d)),
             axis.force_max);
        before = acc;
      }
    }
  }
  return broken;
}

double LimitModel::vibration_coefficient(const RowId& id, int i) const {
  return std::cos(2.0 * std::numbers::pi * id.frequency * task_.sample_period * i - id.angle);
}

double refutation(const LimitModel& model, const Multipliers& y, const Box& box, int symmetric_order) {
  const int n = symmetric_order >= 0 ? symmetric_order : box.order;
  const auto size = static_cast<std::size_t>(n) + 1;
  std::vector<double> c(size, 0.0), on_sum(size + 1, 0.0);
  double rhs = 0.0, magnitude = 0.0;
  std::vector<double> on_delay(box.corners.size(), 0.0), on_sample(box.corners.size(), 0.0);
  Box exact_box = box;
  exact_box.order = n;
  for (const auto& [id, value] : y) {
    if (id.kind == RowKind::cone) {
      const auto j = static_cast<std::size_t>(id.corner);
      const double wp = value * model.weight_in(j, id.angle), wq = value * model.weight_out(j, id.angle);
      if (box.loose(j) && (wp < -1e-16 || wq < -1e-16)) return -infinity;
      for (int i = 0; i <= n; ++i)
        c[static_cast<std::size_t>(i)] += wp * box.weight_in(j, i) + wq * box.weight_out(j, i);
      rhs += value * model.error_bound(j);
    } else if (id.kind == RowKind::range_cone) {
      const auto j = static_cast<std::size_t>(id.corner);
      const double wp = value * model.weight_in(j, id.angle), wq = value * model.weight_out(j, id.angle);
      if (!box.budget || wp < 0.0 || wq < 0.0) return -infinity;
      const RangeRow row = range_row(exact_box, j, id.in, id.out, wp, wq);
      for (std::size_t i = 0; i < size; ++i) c[i] += row.taps[i];
      on_delay[j] += row.on_delay;
      on_sample[j] += row.on_sample;
      rhs += value * model.error_bound(j) - row.constant;
    } else if (id.kind == RowKind::budget) {
      if (!box.budget) return -infinity;
      for (std::size_t j = 0; j < box.corners.size(); ++j) on_delay[j] += value * model.task().corners[j].weight;
      rhs += value * *box.budget;
    } else if (id.kind == RowKind::vibration) {
      for (int i = 0; i <= n; ++i) c[static_cast<std::size_t>(i)] += value * model.vibration_coefficient(id, i);
      rhs += value * model.task().machine.modes[static_cast<std::size_t>(id.mode)].residual_max;
    } else {
      const bool blend = id.corner >= 0;
      if (blend && id.kind != RowKind::speed &&
          box.corners[static_cast<std::size_t>(id.corner)].d1 != box.corners[static_cast<std::size_t>(id.corner)].d2)
        return -infinity;
      // Of a longer filter or delay: at constant speed by now.
      if (id.kind >= RowKind::power_start &&
          id.sample > (id.kind == RowKind::tube ? n : model.last_sample(id, exact_box)))
        continue;
      if (id.kind >= RowKind::power_start && !model.covers(id, exact_box)) return -infinity;
      const SparseRow row = model.row(id, exact_box);
      if (row.taps.empty() && row.sums.empty() && row.constant <= 1.0) continue;
      for (const auto& [i, x] : row.taps) c[static_cast<std::size_t>(i)] += value * x;
      for (const auto& [k, x] : row.sums) on_sum[static_cast<std::size_t>(k)] += value * x;
      rhs += value * (1.0 - row.constant);
    }
    magnitude += value;
  }
  double suffix = 0.0;
  for (std::size_t i = size; i-- > 0;) {
    suffix += on_sum[i + 1];
    c[i] += suffix;
  }
  if (symmetric_order >= 0) {
    for (std::size_t i = 0; i < size / 2; ++i) c[i] = c[size - 1 - i] = 0.5 * (c[i] + c[size - 1 - i]);
  }
  // Least sum c_i b_i: fill the cheapest taps.
  const double u = model.tap_max();
  if (static_cast<double>(size) * u < 1.0 - 1e-12) return infinity;
  const auto full = std::min(size - 1, static_cast<std::size_t>(1.0 / u));
  std::nth_element(c.begin(), c.begin() + static_cast<std::ptrdiff_t>(full), c.end());
  double least = 0.0;
  for (std::size_t i = 0; i < full; ++i) least += u * c[i];
  least += (1.0 - u * static_cast<double>(full)) * c[full];
  for (std::size_t j = 0; j < box.corners.size(); ++j) {
    const CornerBox& b = box.corners[j];
    least += std::min(0.0, on_delay[j]) * (b.d2 - b.d1) + std::min(0.0, on_sample[j]) * (b.k2 - b.k1);
  }
  return least - rhs - (box.budget ? 1e-11 : 1e-13) * (magnitude + std::abs(rhs));
}

bool tighten(const Task& task, double target, Box& box) {
  const LinearCost cost = cost_of(task);
  double value = 0.0;
  for (std::size_t j = 0; j < box.corners.size(); ++j) value += cost.delay[j] * box.corners[j].d1;
  const int least = std::max({task.design.order_min, 0, box.order_least});
  box.order = std::min(task.design.order_max, box.order_most);
  box.budget.reset();
  const double limit = target * (1.0 - 1e-9);
  if (target < infinity) {
    const double most = std::ceil((limit - value) / cost.filter - 1.0) - 1.0;  // filter (N + 1) + value < limit
    box.order = static_cast<int>(std::min<double>(box.order, std::max(most, -1.0)));
    const double room = limit - value - cost.filter * (least + 1);
    if (room <= 0.0) return false;
    if (box.corners.size() > 1) box.budget = room;
    for (std::size_t j = 0; j < box.corners.size(); ++j) {
      const int more = static_cast<int>(std::min(1e8, room / cost.delay[j]));
      box.corners[j].d2 = std::min(box.corners[j].d2, box.corners[j].d1 + more);
    }
  }
  return box.order >= least;
}

}  // namespace accdec::exact
