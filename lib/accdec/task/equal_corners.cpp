#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include <accdec/machine/limits.hpp>
#include <accdec/task/equal_corners.hpp>

namespace accdec {
namespace {

constexpr double same_part = 1e-12;

bool same(double a, double b) {
  return std::abs(a - b) <= same_part * std::min(std::abs(a), std::abs(b));
}

bool same_limits(const Axis& a, const Axis& b) {
  return a.mass == b.mass && a.damping == b.damping && a.coulomb == b.coulomb && a.servo_gain == b.servo_gain &&
         a.velocity_feedforward == b.velocity_feedforward && a.response_taps == b.response_taps &&
         a.force_speed == b.force_speed &&
         std::all_of(axis_limits.begin(), axis_limits.end(),
                     [&](const AxisLimit& limit) { return a.*limit.bound == b.*limit.bound; });
}

/// Whether a mode of this axis is bounded.
bool vibrates(const Machine& machine, std::size_t axis) {
  return std::any_of(machine.modes.begin(), machine.modes.end(),
                     [&](const Mode& mode) { return mode.of_axis() && static_cast<std::size_t>(mode.axis) == axis; });
}

}  // namespace

bool ask_the_same(const Machine& machine, const TaskCorner& a, const TaskCorner& b) {
  if (a.error_max != b.error_max || a.speed_min != b.speed_min || a.contour_max != b.contour_max || a.delay != b.delay)
    return false;
  const Corner &g = a.geometry(), &h = b.geometry();
  if (g.feed_in != h.feed_in || g.feed_out != h.feed_out || g.axes() != h.axes()) return false;
  // The error is |p - q| plus a part from the turn: for nearly collinear legs the digits of the turn itself count.
  if (!same(1.0 + g.cos_interior(), 1.0 + h.cos_interior())) return false;
  std::vector<char> taken(static_cast<std::size_t>(h.axes()), 0);
  const auto matches = [&](Eigen::Index x, Eigen::Index y) {
    const auto i = static_cast<std::size_t>(x), j = static_cast<std::size_t>(y);
    if (taken[j] != 0) return false;
    if (i != j && (vibrates(machine, i) || vibrates(machine, j) || !same_limits(machine.axes[i], machine.axes[j])))
      return false;
    return (same(g.direction_in[x], h.direction_in[y]) && same(g.direction_out[x], h.direction_out[y])) ||
           (same(g.direction_in[x], -h.direction_in[y]) && same(g.direction_out[x], -h.direction_out[y]));
  };
  for (Eigen::Index x = 0; x < g.axes(); ++x) {
    Eigen::Index y = 0;
    while (y < h.axes() && !matches(x, y)) ++y;
    if (y == h.axes()) return false;
    taken[static_cast<std::size_t>(y)] = 1;
  }
  return true;
}

std::vector<int> MergedTask::expand(const std::vector<int>& delays) const {
  std::vector<int> all;
  for (const int j : of) all.push_back(delays[static_cast<std::size_t>(j)]);
  return all;
}

MergedTask merge_equal_corners(const Task& task) {
  std::vector<std::size_t> firsts;  // of each kind
  std::vector<int> of;
  using Key = std::tuple<double, double, double, double, double, int>;
  std::map<Key, std::vector<int>> alike;
  for (const TaskCorner& corner : task.corners) {
    const Key key{corner.geometry().feed_in,         corner.geometry().feed_out, corner.error_max.value_or(-1.0),
                  corner.contour_max.value_or(-1.0), corner.speed_min,           corner.delay.value_or(-1)};
    std::vector<int>& kinds = alike[key];
    const auto first = [&](int j) -> const TaskCorner& { return task.corners[firsts[static_cast<std::size_t>(j)]]; };
    const auto known =
        std::find_if(kinds.begin(), kinds.end(), [&](int j) { return ask_the_same(task.machine, first(j), corner); });
    if (known == kinds.end()) {
      kinds.push_back(static_cast<int>(firsts.size()));
      firsts.push_back(of.size());
      of.push_back(kinds.back());
    } else {
      of.push_back(*known);
    }
  }
  if (firsts.size() == task.corners.size()) return {};
  MergedTask merged{task, std::move(of)};
  merged.task.corners.clear();
  for (const std::size_t j : firsts) {
    merged.task.corners.push_back(task.corners[j]);
    merged.task.corners.back().weight = 0.0;
  }
  for (std::size_t j = 0; j < task.corners.size(); ++j)
    merged.task.corners[static_cast<std::size_t>(merged.of[j])].weight += task.corners[j].weight;
  return merged;
}

}  // namespace accdec
