#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <accdec/certificate/checked_rows.hpp>
#include <accdec/certificate/merged_corners.hpp>
#include <accdec/machine/limits.hpp>

namespace accdec {
namespace {

bool alike(double a, double b) {
  return std::abs(a - b) <= 1e-12 * std::min(std::abs(a), std::abs(b));
}

bool axes_alike(const Axis& a, const Axis& b) {
  bool alike = a.mass == b.mass && a.damping == b.damping && a.coulomb == b.coulomb && a.force_speed == b.force_speed;
  for (const AxisLimit& limit : axis_limits) alike = alike && a.*limit.bound == b.*limit.bound;
  return alike;
}

/// A corner's requirements on one axis, whichever way the axis points.
struct Asked {
  const Axis* axis;
  double in, out;
  bool reverses;
  int vibrates;  ///< number of an axis that has a mode of its own, which no other axis stands for; else -1

  bool operator==(const Asked& other) const {
    return axes_alike(*axis, *other.axis) && alike(in, other.in) && alike(out, other.out) &&
           reverses == other.reverses && vibrates == other.vibrates;
  }
};

std::vector<Asked> asked_of(const Machine& machine, const Corner& corner) {
  std::vector<Asked> asked;
  for (Eigen::Index a = 0; a < corner.axes(); ++a) {
    const double in = corner.direction_in[a], out = corner.direction_out[a];
    const bool own =
        std::any_of(machine.modes.begin(), machine.modes.end(), [&](const Mode& m) { return m.axis == a; });
    asked.push_back({&machine.axes[static_cast<std::size_t>(a)], std::abs(in), std::abs(out), in * out < 0.0,
                     own ? static_cast<int>(a) : -1});
  }
  return asked;
}

/// Whether two corners have the same requirements, up to the order and the direction of their axes. It counts; the
/// search matches instead.
bool one_question(const Machine& machine, const TaskCorner& a, const TaskCorner& b) {
  const Corner &g = a.geometry(), &h = b.geometry();
  if (a.error_max != b.error_max || a.contour_max != b.contour_max || a.speed_min != b.speed_min ||
      a.delay != b.delay || g.feed_in != h.feed_in || g.feed_out != h.feed_out || g.axes() != h.axes() ||
      !alike(1.0 + g.cos_interior(), 1.0 + h.cos_interior()))
    return false;
  const std::vector<Asked> of_a = asked_of(machine, g), of_b = asked_of(machine, h);
  return std::all_of(of_a.begin(), of_a.end(), [&](const Asked& asked) {
    return std::count(of_a.begin(), of_a.end(), asked) == std::count(of_b.begin(), of_b.end(), asked);
  });
}

}  // namespace

Task merged_corners(const Task& task, const std::vector<int>& corner_of) {
  if (corner_of.empty()) return task;
  if (corner_of.size() != task.corners.size())
    throw Rejected(
        fmt::format("the certificate merges {} corners, the task has {}", corner_of.size(), task.corners.size()));
  Task merged = task;
  merged.corners.clear();
  for (std::size_t i = 0; i < task.corners.size(); ++i) {
    const int kinds = static_cast<int>(merged.corners.size()), kind = corner_of[i];
    if (kind < 0 || kind > kinds) throw Rejected("the certificate merges a corner with one that is not there");
    if (kind == kinds) {
      merged.corners.push_back(task.corners[i]);
      continue;
    }
    TaskCorner& first = merged.corners[static_cast<std::size_t>(kind)];
    if (!one_question(task.machine, first, task.corners[i]))
      throw Rejected(fmt::format("the certificate takes corners {} and {} for one, but they are not", first.name,
                                 task.corners[i].name));
    first.weight += task.corners[i].weight;
  }
  return merged;
}

Task with_smoothing(const Task& task) {
  const std::vector<double> taps = task.machine.prefilter_taps;
  if (taps.empty()) throw Rejected("the certificate is about a smoothing that the control does not have");
  Task one = task;
  one.machine.prefilter_taps.clear();
  one.design.order_min += static_cast<int>(taps.size()) - 1;
  one.design.order_max += static_cast<int>(taps.size()) - 1;
  one.design.symmetric = task.design.symmetric && std::equal(taps.begin(), taps.end(), taps.rbegin());
  return one;
}

}  // namespace accdec
