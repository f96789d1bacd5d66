#include <algorithm>
#include <cmath>
#include <limits>

#include <accdec/exact/window.hpp>
#include <accdec/machine/limits.hpp>

namespace accdec::exact {

namespace {

/// The part of a row that concerns the taps inside.
struct Inside {
  const Box& box;
  const ConvexRows& rows;
  /// Whether a tap behind a smoothing is made of designed taps inside alone.
  bool inner(int tap, const Smoothing& smoothing) const { return tap - smoothing.order() >= 1 && tap <= box.order - 1; }

  bool operator()(const proof::Error&) const { return true; }
  /// The rest of a damped vibration depends on how far the filter's end is.
  bool operator()(const proof::Vibration& row) const {
    return row.damping == 0.0 && row.corner < 0 && rows.smoothing().none();
  }
  bool operator()(const proof::TapDifference& row) const {
    return inner(row.sample, rows.smoothing()) &&
           inner(row.sample - axis_limit(row.limit).differences, rows.smoothing());
  }
  bool operator()(const proof::EventForce& row) const { return rows.servo() || inner(row.sample - 1, rows.motion()); }
  bool operator()(const proof::Blend& row) const {
    const CornerBox& c = box.corner(row.corner);
    const int newest = row.sample - 1, oldest = newest - std::max(axis_limit(row.limit).differences, 0);
    const auto inside = [&](int tap) { return inner(tap, rows.smoothing()) && inner(tap - c.d1, rows.smoothing()); };
    return c.d1 == c.d2 && ((rows.servo() && axis_limit(row.limit).load) || (inside(newest) && inside(oldest)));
  }
  template <class Other>
  bool operator()(const Other&) const {
    return false;
  }
};

}  // namespace

bool inside_window(const proof::Row& id, const Box& box, const ConvexRows& rows) {
  return std::visit(Inside{box, rows}, id);
}

void add_window_vibration(const LimitModel& model, const proof::Vibration& id, double y, std::span<double> taps) {
  const double first = taps.front(), last = taps.back();
  model.rows.add_vibration(id, y, taps);
  taps.front() = first - y, taps.back() = last - y;
}

double window_refutation(const LimitModel& written, const Multipliers& y, const Box& box) {
  const LimitModel& model = written.granted();
  WeightedTaps sum(model.rows.smoothing(), box.order);
  double rhs = 0.0, magnitude = 0.0;
  for (const auto& [id, value] : y) {
    magnitude += value;
    if (!inside_window(id, box, model.rows)) return -std::numeric_limits<double>::infinity();
    if (const auto* error = std::get_if<proof::Error>(&id)) {
      const auto j = static_cast<std::size_t>(error->corner);
      const double wp = value * model.weight_in(j, error->angle), wq = value * model.weight_out(j, error->angle);
      if (wp < -1e-16 || wq < -1e-16) return -std::numeric_limits<double>::infinity();
      for (int i = 0; i <= box.order; ++i)
        sum.designed()[static_cast<std::size_t>(i)] += wp * box.weight_in(j, i) + wq * box.weight_out(j, i);
      rhs += value * model.error_bound(j);
      continue;
    }
    if (const auto* vibration = std::get_if<proof::Vibration>(&id)) {
      add_window_vibration(model, *vibration, value, sum.command());
      rhs += value * model.rows.vibration_bound(*vibration);
      continue;
    }
    const SparseRow row = model.row(id, box);
    model.rows.add(row, value, true, sum);
    rhs += value * (1.0 - row.constant);
  }
  std::vector<double>& c = sum.all();
  // Least sum c_i b_i: the cheapest taps inside are full, and the cheaper end takes the rest.
  const double end = std::min(c.front(), c.back()), most = 1.0 / model.rows.tap_max();
  const auto dear = std::partition(c.begin() + 1, c.end() - 1, [&](double x) { return x < end; });
  const auto full = c.begin() + 1 + std::min(dear - c.begin() - 1, static_cast<std::ptrdiff_t>(most));
  std::nth_element(c.begin() + 1, full, dear);
  double least = 0.0;
  for (auto tap = c.begin() + 1; tap != full; ++tap) least += model.rows.tap_max() * *tap;
  const double left = 1.0 - model.rows.tap_max() * static_cast<double>(full - c.begin() - 1);
  least += left * (full != dear ? *full : end);
  return least - rhs - 1e-12 * (magnitude + std::abs(rhs));
}

}  // namespace accdec::exact
