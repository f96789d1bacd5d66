#include <fmt/format.h>

#include <accdec/machine/limits.hpp>
#include <accdec/machine/mode_text.hpp>
#include <accdec/task/conflict.hpp>

namespace accdec {
namespace {

struct Limit {
  std::string name;
  std::function<void(Task&)> leave_out;
};

std::vector<Limit> limits_of(const Task& task, bool each_axis) {
  std::vector<Limit> limits;
  const std::size_t axes = task.machine.axes.size();
  const auto axis_limit = [&](const AxisLimit& limit, std::size_t first, std::size_t last, std::string name) {
    bool present = false;
    for (std::size_t a = first; a < last; ++a) present = present || task.machine.axes[a].*limit.bound < unlimited;
    if (!present) return;
    limits.push_back({std::move(name), [=, bound = limit.bound](Task& t) {
                        for (std::size_t a = first; a < last; ++a) t.machine.axes[a].*bound = unlimited;
                      }});
  };
  for (const AxisLimit& limit : axis_limits) {
    // A blend is never faster than its faster leg, so a velocity limit that cannot be held is a contradiction by
    // itself.
    if (limit.kind == LimitKind::velocity) continue;
    const std::string kind(to_string(limit.kind));
    if (!each_axis) axis_limit(limit, 0, axes, kind);
    for (std::size_t a = 0; each_axis && a < axes; ++a)
      axis_limit(limit, a, a + 1, kind + " " + task.machine.axes[a].name);
  }
  for (const SupplyLimit& limit : supply_limits) {
    if (task.machine.*limit.bound == unlimited) continue;
    limits.push_back(
        {std::string(to_string(limit.kind)), [bound = limit.bound](Task& t) { t.machine.*bound = unlimited; }});
  }
  for (std::size_t j = 0; j < task.corners.size(); ++j) {
    const TaskCorner& corner = task.corners[j];
    if (corner.error_max)
      limits.push_back(
          {std::string(error_in_conflict) + corner.name, [j](Task& t) { t.corners[j].error_max.reset(); }});
    if (corner.contour_max)
      limits.push_back({"contour " + corner.name, [j](Task& t) { t.corners[j].contour_max.reset(); }});
    if (corner.speed_min > 0.0)
      limits.push_back({"smallest speed " + corner.name, [j](Task& t) { t.corners[j].speed_min = 0.0; }});
    if (corner.delay)
      limits.push_back({std::string(delay_in_conflict) + corner.name, [j](Task& t) { t.corners[j].delay.reset(); }});
  }
  for (std::size_t i = 0; i < task.machine.modes.size(); ++i) {
    const Mode& mode = task.machine.modes[i];
    limits.push_back(
        {mode.of_axis()
             ? "residual " + task.machine.axes[static_cast<std::size_t>(mode.axis)].name + " " + range_of(mode)
             : "vibration " + range_of(mode),
         [i](Task& t) { t.machine.modes[i].residual_max = 1.0, t.machine.modes[i].displacement_max = unlimited; }});
  }
  if (task.design.symmetric) limits.push_back({"symmetry", [](Task& t) { t.design.symmetric = false; }});
  return limits;
}

}  // namespace

std::vector<std::string> limits_in_conflict(const Task& task, bool each_axis,
                                            const std::function<bool(const Task&)>& has_design) {
  Task reduced = task;
  std::vector<std::string> needed;
  for (const Limit& limit : limits_of(task, each_axis)) {
    Task trial = reduced;
    limit.leave_out(trial);
    if (has_design(trial)) {
      needed.push_back(limit.name);
    } else {
      reduced = std::move(trial);
    }
  }
  return needed;
}

}  // namespace accdec
