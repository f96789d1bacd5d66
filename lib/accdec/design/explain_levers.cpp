#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <accdec/design.hpp>
#include <accdec/machine/limit_unit.hpp>
#include <accdec/machine/limits.hpp>
#include <accdec/machine/mode_text.hpp>

namespace accdec {
namespace {

std::string words(LimitKind kind, std::string_view axis = {}) {
  std::string text(kind == LimitKind::speed_min ? "smallest speed" : limit_word(kind, axis));
  std::replace(text.begin(), text.end(), '_', ' ');
  return text;
}

Lever limit_lever(LimitKind kind, double value, std::string_view axis = {}) {
  Lever lever;
  lever.kind = kind;
  lever.unit = limit_unit(kind, axis).name;
  lever.per_si = limit_unit(kind, axis).per_si;
  lever.value = lever.scale = value;
  return lever;
}

Lever axis_lever(const AxisLimit& limit, const Task& task, std::size_t a) {
  const Axis& axis = task.machine.axes[a];
  Lever lever = limit_lever(limit.kind, axis.*limit.bound, axis.name);
  lever.name = fmt::format("{} {}", words(limit.kind, axis.name), axis.name);
  lever.key = fmt::format("axis.{}.{}", axis.name, limit_key(limit, axis.name));
  lever.axis = axis.name;
  if (limit.kind == LimitKind::force_speed) {
    // A drive of more force has it at the same speeds.
    lever.end = limit.key_max;
    lever.set = [a](Task& t, double v) { scale_forces(t.machine.axes[a], v); };
  } else {
    lever.set = [a, bound = limit.bound](Task& t, double v) { t.machine.axes[a].*bound = v; };
  }
  return lever;
}

Lever supply_lever(const SupplyLimit& limit, const Task& task) {
  Lever lever = limit_lever(limit.kind, task.machine.*limit.bound);
  lever.name = words(limit.kind);
  lever.key = fmt::format("machine.{}", limit.key);
  lever.set = [bound = limit.bound](Task& t, double v) { t.machine.*bound = v; };
  return lever;
}

/// One of the two tolerances of a corner.
Lever tolerance_lever(const TaskCorner& corner, std::size_t j, LimitKind kind, std::string_view name,
                      std::string_view key, std::optional<double> TaskCorner::*tolerance) {
  Lever lever = limit_lever(kind, *(corner.*tolerance));
  lever.name = fmt::format("{} {}", name, corner.name);
  lever.key = fmt::format("corner.{}.{}", corner.name, key);
  lever.corner = corner.name;
  lever.end = 10.0;
  if (lever.value == 0.0) lever.scale = 1e-6;
  lever.set = [j, tolerance](Task& t, double v) { t.corners[j].*tolerance = v; };
  return lever;
}

Lever speed_lever(const TaskCorner& corner, std::size_t j) {
  Lever lever = limit_lever(LimitKind::speed_min, corner.speed_min);
  lever.name = "smallest speed " + corner.name;
  lever.key = fmt::format("corner.{}.speed_min_mm_s", corner.name);
  lever.corner = corner.name;
  lever.upper = false;
  lever.end = 0.0;
  lever.set = [j](Task& t, double v) { t.corners[j].speed_min = v; };
  return lever;
}

Lever axis_mode_lever(const Task& task, std::size_t i) {
  const Mode& mode = task.machine.modes[i];
  const std::string& axis = task.machine.axes[static_cast<std::size_t>(mode.axis)].name;
  Lever lever = limit_lever(LimitKind::residual, mode.displacement_max, axis);
  lever.axis = axis;
  lever.name = fmt::format("residual {} {}", lever.axis, range_of(mode));
  lever.key = fmt::format("mode.{}.residual_max_um", i);
  lever.frequency_low = mode.frequency_low;
  lever.frequency_high = mode.frequency_high;
  lever.set = [i](Task& t, double v) { t.machine.modes[i].displacement_max = v; };
  return lever;
}

Lever mode_lever(const Mode& mode, std::size_t i) {
  Lever lever = limit_lever(LimitKind::vibration, mode.residual_max);
  lever.name = "vibration " + range_of(mode);
  lever.key = fmt::format("mode.{}.residual_max", i);
  lever.frequency_low = mode.frequency_low;
  lever.frequency_high = mode.frequency_high;
  lever.end = 1.0;
  if (lever.value == 0.0) lever.scale = 1e-3;
  lever.set = [i](Task& t, double v) { t.machine.modes[i].residual_max = v; };
  return lever;
}

/// A feed may only fall, down to a hundredth.
Lever feed_lever(const TaskCorner& corner, std::size_t j, bool in) {
  Lever lever;
  lever.name = fmt::format("feed {} {}", in ? "in" : "out", corner.name);
  lever.key = fmt::format("corner.{}.feed_{}_mm_min", corner.name, in ? "in" : "out");
  lever.unit = "mm/min";
  lever.per_si = 6e4;
  lever.corner = corner.name;
  lever.value = lever.scale = in ? corner.geometry().feed_in : corner.geometry().feed_out;
  lever.end = 0.01 * lever.value;
  lever.upper = false;
  lever.set = [j, in](Task& t, double v) {
    const Corner& now = t.corners[j].geometry();
    t.corners[j].set_feeds(in ? v : now.feed_in, in ? now.feed_out : v);
  };
  return lever;
}

Lever delay_lever(const Task& task, std::size_t j) {
  Lever lever;
  lever.name = "delay " + task.corners[j].name;
  lever.key = fmt::format("corner.{}.delay_samples", task.corners[j].name);
  lever.unit = "samples";
  lever.corner = task.corners[j].name;
  lever.value = *task.corners[j].delay;
  lever.scale = std::max(1.0, lever.value);
  // From N + 2 on nothing changes.
  lever.end = std::max(lever.value, 2.0 + (task.filter ? make_filter(*task.filter).order() : task.design.order_max));
  lever.whole = true;
  lever.set = [j](Task& t, double v) { t.corners[j].delay = static_cast<int>(std::lround(v)); };
  return lever;
}

}  // namespace

double Lever::moved(double share) const {
  double step = share * scale;
  if (whole) step = std::max(1.0, std::ceil(step - 1e-9));
  return upper ? std::min(value + step, end) : std::max(value - step, end);
}

bool Lever::concerns(const LimitUse& use) const {
  if (use.kind != kind) return false;
  if (of_mode(use.kind))
    return use.bound == value && use.axis == axis && use.frequency >= frequency_low && use.frequency <= frequency_high;
  return use.axis == axis && (corner.empty() || use.corner == corner);
}

Task Room::given_to(const Task& task, double share) const {
  Task moved = task;
  for (const Lever& lever : levers) lever.set(moved, lever.moved(share));
  return moved;
}

Task Room::all_given_to(const Task& task) const {
  Task moved = task;
  for (const Lever& lever : levers) lever.set(moved, lever.end);
  return moved;
}

std::vector<Lever> limit_levers(const Task& task) {
  std::vector<Lever> levers;
  for (const AxisLimit& limit : axis_limits) {
    for (std::size_t a = 0; a < task.machine.axes.size(); ++a) {
      if (task.machine.axes[a].*limit.bound < unlimited) levers.push_back(axis_lever(limit, task, a));
    }
  }
  for (const SupplyLimit& limit : supply_limits) {
    if (task.machine.*limit.bound < unlimited) levers.push_back(supply_lever(limit, task));
  }
  for (std::size_t j = 0; j < task.corners.size(); ++j) {
    const TaskCorner& corner = task.corners[j];
    if (corner.error_max)
      levers.push_back(
          tolerance_lever(corner, j, LimitKind::corner_error, "corner error", "error_max_um", &TaskCorner::error_max));
    if (corner.contour_max)
      levers.push_back(
          tolerance_lever(corner, j, LimitKind::contour, "contour", "contour_max_um", &TaskCorner::contour_max));
  }
  for (std::size_t j = 0; j < task.corners.size(); ++j) {
    if (task.corners[j].speed_min > 0.0) levers.push_back(speed_lever(task.corners[j], j));
  }
  for (std::size_t i = 0; i < task.machine.modes.size(); ++i) {
    if (task.machine.modes[i].of_axis()) levers.push_back(axis_mode_lever(task, i));
    if (task.machine.modes[i].residual_max < 1.0) levers.push_back(mode_lever(task.machine.modes[i], i));
  }
  return levers;
}

Lever order_lever(const Task& task) {
  Lever lever;
  lever.name = "highest order";
  lever.key = "design.order_max";
  lever.value = task.design.order_max;
  lever.scale = std::max(1.0, lever.value);
  lever.end = std::max(400.0, 4.0 * lever.value);
  lever.whole = true;
  lever.set = [](Task& t, double v) { t.design.order_max = static_cast<int>(std::lround(v)); };
  return lever;
}

std::vector<Room> other_rooms(const Task& task) {
  std::vector<Room> rooms;
  Room all{"feeds of all corners", "", {}};
  for (std::size_t j = 0; j < task.corners.size(); ++j) {
    const TaskCorner& corner = task.corners[j];
    Room feeds{"feeds of corner " + corner.name, "", {feed_lever(corner, j, true), feed_lever(corner, j, false)}};
    all.levers.insert(all.levers.end(), feeds.levers.begin(), feeds.levers.end());
    if (task.corners.size() <= corners_apart_max) rooms.push_back(std::move(feeds));
  }
  if (task.corners.size() > 1) rooms.insert(rooms.begin(), std::move(all));
  for (std::size_t j = 0; j < task.corners.size() && task.corners.size() <= corners_apart_max; ++j) {
    if (!task.corners[j].delay) continue;
    Lever lever = delay_lever(task, j);
    rooms.push_back({lever.name, lever.key, {std::move(lever)}});
  }
  if (!task.filter) {
    Lever lever = order_lever(task);
    rooms.push_back({lever.name, lever.key, {std::move(lever)}});
  }
  return rooms;
}

std::vector<Room> rooms_of(const std::vector<Lever>& levers) {
  std::vector<Room> rooms;
  for (auto first = levers.begin(); first != levers.end();) {
    const auto last = std::find_if(first, levers.end(), [&](const Lever& l) { return l.kind != first->kind; });
    if (last - first > 1 && first->kind) {
      const bool by_axis = !first->axis.empty(), by_corner = !first->corner.empty();
      // "axis.x.jerk_max_mm_s3" with a * for the name; in the keys used here, names have no dots.
      const std::string last_part = first->key.substr(first->key.rfind('.'));
      const bool one_key = std::all_of(first, last, [&](const Lever& l) { return l.key.ends_with(last_part); });
      rooms.push_back({fmt::format("{} {}", words(*first->kind),
                                   by_axis     ? "of all axes"
                                   : by_corner ? "at all corners"
                                               : "of all modes"),
                       !one_key ? ""
                                : (by_axis     ? "axis.*"
                                   : by_corner ? "corner.*"
                                               : "mode.*") +
                                      last_part,
                       {first, last}});
    }
    const bool too_many = !first->corner.empty() && static_cast<std::size_t>(last - first) > corners_apart_max;
    for (; first != last; ++first) {
      if (!too_many) rooms.push_back({first->name, first->key, {*first}});
    }
  }
  return rooms;
}

}  // namespace accdec
