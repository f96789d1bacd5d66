#include <algorithm>
#include <cmath>

#include <accdec/certificate/checked_rows.hpp>

// One in-position width w for all corners. A corner of feed v has the delay L + e with the control's latency L, where e
// is the first sample at which v T p(e) <= w. So v_i p(e_i) <= w/T < v_j p(e_j - 1) for all corners i, and j with e_j >
// 0.

namespace accdec {
namespace {

/// The bound of a row is wider by this, in samples: verification computes the ways in floating point.
constexpr double granted_way = 1e-9;
/// Speeds count as equal up to this part: widths that differ by less are one.
constexpr double same_speed = 1e-12;

}  // namespace

int CheckedRows::latency() const {
  return static_cast<int>(std::lround(task_.settings->in_position_latency / task_.sample_period));
}

/// The speed of the way that the control watches: along leg 1, or of its fastest axis.
double CheckedRows::watched_speed(const TaskCorner& corner) const {
  const Corner& g = corner.geometry();
  double fastest = task_.settings->in_position_by_axis ? 0.0 : g.feed_in;
  for (Eigen::Index a = 0; task_.settings->in_position_by_axis && a < g.axes(); ++a)
    fastest = std::max(fastest, g.feed_in * std::abs(g.direction_in[a]));
  return fastest;
}

/// p falls and v_i p(e_i) < v_j p(e_j - 1). So where v_i >= v_j, e_i > e_j - 1.
void CheckedRows::order_delays(CheckedBox& box) const {
  const std::size_t count = box.corners.size();
  for (CheckedRange& r : box.corners) r.d1 = std::max(r.d1, latency());
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j < count; ++j) {
      if (watched_speed(task_.corners[i]) < watched_speed(task_.corners[j]) * (1.0 - same_speed)) continue;
      box.corners[i].d1 = std::max(box.corners[i].d1, box.corners[j].d1);
      box.corners[j].d2 = std::min(box.corners[j].d2, box.corners[i].d2);
    }
  }
}

void CheckedRows::end_delays(CheckedBox& box) const {
  const int longer =
      task_.settings->in_position_actual ? response_.longer() : static_cast<int>(response_.command().size()) - 1;
  for (CheckedRange& r : box.corners) r.d2 = std::min(r.d2, box.order + longer + latency());
  order_delays(box);
}

void CheckedRows::add_row(const proof::Width& row, const Interval& weight, CheckedBox& box, CheckedSum& sum) const {
  if (!box.in_position || task_.design.symmetric) throw Rejected("a multiplier names an in-position width");
  const double within = watched_speed(corner(row.within)), before = watched_speed(corner(row.before));
  const int after = box.corners[static_cast<std::size_t>(row.within)].d2 - latency(),
            last = box.corners[static_cast<std::size_t>(row.before)].d1 - latency() - 1;
  if (last < 0) throw Rejected("a multiplier names the width before a corner that may not wait for it");
  const Interval faster(std::max(within, before));
  const auto add = [&](int sample, const Interval& c) {
    if (task_.settings->in_position_actual) {
      for (int i = std::max(0, sample + 1 - longer()); i <= sum.order(); ++i)
        sum.tap(i, c * response_.left(i - sample));
      return;
    }
    const int commands = sum.order() + static_cast<int>(response_.command().size()) - 1;
    for (int i = sample + 1; i <= commands; ++i)
      sum.tap_behind(response_.command(), i, c * static_cast<double>(i - sample));
  };
  add(after, weight * Interval(within) / faster);
  add(last, -1.0 * weight * Interval(before) / faster);
  sum.rhs = sum.rhs + weight * Interval(granted_way);
}

}  // namespace accdec
