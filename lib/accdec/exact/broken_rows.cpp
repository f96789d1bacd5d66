#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include <accdec/exact/rows.hpp>

// Rows that a filter breaks.

namespace accdec::exact {

/// Rows that a filter breaks. Every limit is seen at all its samples in turn.
class ConvexRows::Broken {
 public:
  Broken(double slack, bool peaks) : slack_(slack), peaks_(peaks) {}

  /// @param use  of the bound at the next sample
  void see(double use, const auto& row) {
    const bool broken = use > 1.0 + slack_;
    if (broken && !peaks_) rows_.push_back(row);
    if (!peaks_) return;
    if (use < before_) end();
    if (broken && use >= before_) peak_ = row;
    before_ = use;
  }
  /// After the last sample of a limit.
  void end() {
    if (peak_) rows_.push_back(*peak_);
    peak_.reset();
    before_ = 0.0;
  }
  std::vector<proof::Row> rows() { return std::move(rows_); }

 private:
  const double slack_;
  const bool peaks_;
  double before_ = 0.0;
  std::optional<proof::Row> peak_;
  std::vector<proof::Row> rows_;
};

/// The filter's taps at the ends stand for others, too: rows there are weaker than the filter's own forces.
void ConvexRows::leave_broken_in_window(const Filter& filter, const Box& box, double slack,
                                        std::vector<proof::Row>& rows) const {
  std::vector<double> weights(filter.taps().size());
  std::erase_if(rows, [&](const proof::Row& id) {
    const auto* force = std::get_if<proof::EventForce>(&id);
    const SparseRow sparse = force != nullptr ? row(*force, box) : row(std::get<proof::Blend>(id), box);
    std::fill(weights.begin(), weights.end(), 0.0);
    add_motion(sparse, 1.0, true, weights);
    return std::inner_product(weights.begin(), weights.end(), filter.taps().begin(), sparse.constant) <= 1.0 + slack;
  });
}

void ConvexRows::add_broken_event_forces(const Filter& motion, std::size_t a, Broken& out) const {
  const Axis& axis = task_.machine.axes[a];
  for (int line = servo() ? first_line(a) : 0; line < static_cast<int>(lines_[a].size()); ++line) {
    for (const bool stop : {false, true}) {
      const double speed = stop ? speeds_[a].stop : speeds_[a].start;
      const ForceRow force = force_row(static_cast<int>(a), line, stop ? -1.0 : 1.0, 1.0);
      for (int k = 1; speed > 0.0 && k <= motion.order() + 1; ++k) {
        const double left = axis.mass * motion.tap(k - 1) / task_.sample_period +
                            force.drag * (stop ? motion.remaining(k) : motion.cumulative(k));
        out.see((speed * left + (stop ? -axis.coulomb : axis.coulomb)) / force.bound,
                proof::EventForce{stop, static_cast<int>(a), k, line});
      }
      out.end();
    }
  }
}

void ConvexRows::add_broken_reversals(const Filter& motion, const Box& box, Broken& out) const {
  for (const ReversalRange& range : box.reversals) {
    const CornerBox& c = box.corner(range.corner);
    if (c.d1 != c.d2) continue;
    for (const proof::Reversal& id : {proof::Reversal{range.corner, range.axis, range.first - 1, -1},
                                      proof::Reversal{range.corner, range.axis, range.last, 1}}) {
      const SparseRow reversal = row(id, box);
      double value = reversal.constant;
      for (const auto& [k, coefficient] : reversal.sums) value += coefficient * motion.cumulative(k);
      out.see(value, id);
      out.end();
    }
  }
}

void ConvexRows::add_broken_forces(const Filter& motion, const Box& box, std::size_t j, std::size_t a,
                                   Broken& out) const {
  const Axis& axis = task_.machine.axes[a];
  const Legs v = legs(task_.corners[j], a);
  const int d = box.corners[j].d1, reversed = box.reversal(static_cast<int>(j), static_cast<int>(a)).last;
  std::vector<std::pair<double, double>> moved;  // speed and force
  for (int k = 1; k <= box.order + motion_.order() + d + 1; ++k) {
    const double speed = v.in * motion.remaining(k) + v.out * motion.cumulative(k - d);
    const double acceleration = (v.out * motion.tap(k - 1 - d) - v.in * motion.tap(k - 1)) / task_.sample_period;
    moved.emplace_back(speed, axis.mass * acceleration + axis.damping * speed);
  }
  for (int line = first_line(a); line < static_cast<int>(lines_[a].size()); ++line) {
    const LimitKind limit = line < 0 ? LimitKind::force : LimitKind::force_speed;
    const ForceLine of = line < 0 ? ForceLine{0.0, axis.force_max} : lines_[a][static_cast<std::size_t>(line)];
    for (const int sign : {1, -1}) {
      proof::Blend id{limit, static_cast<int>(j), static_cast<int>(a), 0, sign, std::max(line, 0)};
      for (const auto& [speed, force] : moved) {
        ++id.sample;
        if (line >= 0) id.direction = speed < 0.0 ? -1 : 1;
        const double help = friction_help(axis, v, sign, id.sample >= reversed);
        out.see((sign * force + of.slope * std::abs(speed) - help) / of.force, id);
      }
      out.end();
    }
  }
}

void ConvexRows::add_broken_differences(const Filter& command, const Box& box, std::size_t j, std::size_t a,
                                        Broken& out) const {
  const Axis& axis = task_.machine.axes[a];
  const Legs v = legs(task_.corners[j], a);
  const int d = box.corners[j].d1;
  std::vector<const AxisLimit*> bounded;  // each difference that is computed costs time at every sample
  std::size_t used = 0;
  for (const AxisLimit& limit : axis_limits) {
    if (limit.differences < 0 || !(axis.*limit.bound < unlimited)) continue;
    bounded.push_back(&limit);
    used = std::max(used, static_cast<std::size_t>(limit.differences) + 1);
  }
  std::array<double, most_differences + 1> difference{};  // of the acceleration, over T each time
  for (int k = 1; used > 0 && k <= box.order + smoothing_.order() + d + 1 + most_differences; ++k) {
    double next = (v.out * command.tap(k - 1 - d) - v.in * command.tap(k - 1)) / task_.sample_period;
    for (std::size_t i = 0; i < used; ++i) next = (next - std::exchange(difference[i], next)) / task_.sample_period;
    for (const AxisLimit* limit : bounded) {
      const double value = difference[static_cast<std::size_t>(limit->differences)];
      out.see(std::abs(value) / (axis.*(limit->bound)),
              proof::Blend{limit->kind, static_cast<int>(j), static_cast<int>(a), k, value > 0.0 ? 1 : -1});
    }
  }
}

std::vector<proof::Row> ConvexRows::broken_blend_rows(const Filter& filter, const Box& box, double slack,
                                                      bool peaks) const {
  Broken loads(slack, peaks && servo() && !box.window), others(slack, false);
  std::optional<Filter> made, moved;
  const Filter& command = smoothing_.behind(filter, made);
  // A servo may have far more taps than the filter: its motion is made for forces alone.
  const Filter& motion = servo() && limits_forces() ? motion_.behind(filter, moved) : command;
  for (std::size_t a = 0; a < lines_.size(); ++a) add_broken_event_forces(motion, a, loads);
  add_broken_reversals(motion, box, others);
  for (std::size_t j = 0; j < box.corners.size(); ++j) {
    if (box.corners[j].d1 != box.corners[j].d2) continue;
    for (std::size_t a = 0; a < task_.machine.axes.size(); ++a) {
      const Legs v = legs(task_.corners[j], a);
      if (v.in == 0.0 || v.out == 0.0) continue;
      add_broken_forces(motion, box, j, a, loads);
      add_broken_differences(command, box, j, a, others);
    }
  }
  std::vector<proof::Row> all = loads.rows();
  if (box.window && servo()) leave_broken_in_window(filter, box, slack, all);
  const std::vector<proof::Row> rest = others.rows();
  all.insert(all.end(), rest.begin(), rest.end());
  return all;
}

}  // namespace accdec::exact
