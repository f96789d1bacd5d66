#include <algorithm>
#include <cmath>

#include <accdec/exact/one_width.hpp>

namespace accdec::exact {
namespace {

double feed_of(const Task& task, int corner) {
  return watched_speed(*task.settings, task.corners[static_cast<std::size_t>(corner)].geometry());
}

/// Speeds this close ask for the same width: no control tells such widths apart.
constexpr double same_width = 1e-12;

bool alike(double a, double b) {
  return std::abs(a - b) <= same_width * std::max(a, b);
}

}  // namespace

bool by_one_width(const Task& task) {
  return task.settings && task.settings->delays == std::vector{DelayKind::in_position};
}

bool same_by_width(const Task& task, int a, int b) {
  return alike(feed_of(task, a), feed_of(task, b));
}

int width_latency(const Task& task) {
  if (!by_one_width(task)) return 0;
  return static_cast<int>(std::lround(task.settings->in_position_latency / task.sample_period));
}

bool order_by_width(const Task& task, std::vector<CornerBox>& corners) {
  const int least = width_latency(task);
  for (CornerBox& c : corners) c.d1 = std::max(c.d1, least);
  const int count = static_cast<int>(corners.size());
  bool left = true;
  for (int i = 0; i < count; ++i) {
    CornerBox& faster = corners[static_cast<std::size_t>(i)];
    for (int j = 0; j < count; ++j) {
      CornerBox& slower = corners[static_cast<std::size_t>(j)];
      if (feed_of(task, i) < feed_of(task, j) * (1.0 - same_width)) continue;
      faster.d1 = std::max(faster.d1, slower.d1);
      slower.d2 = std::min(slower.d2, faster.d2);
    }
  }
  for (const CornerBox& c : corners) left = left && c.d1 <= c.d2;
  return left;
}

bool cut_by_width(const Task& task, Box& box) {
  if (!by_one_width(task) || box.window) return true;
  const int smoothing = std::max(0, static_cast<int>(task.machine.prefilter_taps.size()) - 1);
  const int most = box.order + width_latency(task) + (task.settings->in_position_actual ? box.longer() : smoothing);
  for (CornerBox& c : box.corners) c.d2 = std::min(c.d2, most);
  return order_by_width(task, box.corners);
}

double WidthRow::weight(const Box& box, int tap) const {
  const auto way = [&](int x) { return actual ? box.ramp_in(x) : std::max(0, x); };
  return within * way(tap - sample_within) - before * way(tap - sample_before);
}

std::optional<WidthRow> width_row(const Task& task, const proof::Width& id, const Box& box) {
  if (!by_one_width(task) || box.window || !box.distances.empty() || task.design.symmetric) return std::nullopt;
  const int least = width_latency(task);
  const double within = feed_of(task, id.within), before = feed_of(task, id.before), faster = std::max(within, before);
  const WidthRow row{within / faster, before / faster, box.corner(id.within).d2 - least,
                     box.corner(id.before).d1 - least - 1, task.settings->in_position_actual && box.servo != nullptr};
  if (row.sample_before < 0) return std::nullopt;
  return row;
}

std::optional<proof::Width> broken_width(const Task& task, const Filter& designed, const Filter& command,
                                         const Box& box) {
  std::optional<proof::Width> worst;
  double most = -0.9 * width_margin;
  const int count = static_cast<int>(box.corners.size());
  for (int i = 0; i < count; ++i) {
    for (int j = 0; j < count; ++j) {
      const auto row = same_by_width(task, i, j) ? std::nullopt : width_row(task, {i, j}, box);
      if (!row) continue;
      const Filter& taps = row->actual ? designed : command;
      double value = 0.0;
      for (int k = 0; k <= taps.order(); ++k) value += taps.tap(k) * row->weight(box, k);
      if (value > most) most = value, worst = proof::Width{i, j};
    }
  }
  return worst;
}

}  // namespace accdec::exact
