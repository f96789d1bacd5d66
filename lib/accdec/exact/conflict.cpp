#include <limits>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/exact/conflict.hpp>
#include <accdec/exact/search.hpp>

namespace accdec::exact {
namespace {

struct Droppable {
  std::string name;
  std::function<void(Task&)> drop;
};

std::vector<Droppable> limits_of(const Task& task) {
  std::vector<Droppable> all;
  const auto axis_limit = [&](std::size_t a, const char* kind, double Axis::*limit) {
    if (task.machine.axes[a].*limit < unlimited) {
      all.push_back({fmt::format("{} {}", kind, task.machine.axes[a].name),
                     [a, limit](Task& t) { t.machine.axes[a].*limit = unlimited; }});
    }
  };
  for (std::size_t a = 0; a < task.machine.axes.size(); ++a) {
    axis_limit(a, "acceleration", &Axis::acceleration_max);
    axis_limit(a, "jerk", &Axis::jerk_max);
    axis_limit(a, "force", &Axis::force_max);
    axis_limit(a, "power", &Axis::power_max);
    axis_limit(a, "regeneration", &Axis::regeneration_max);
  }
  for (std::size_t m = 0; m < task.machine.modes.size(); ++m) {
    const Mode& mode = task.machine.modes[m];
    all.push_back({fmt::format("vibration {:.6g} to {:.6g} Hz", mode.frequency_low, mode.frequency_high),
                   [m](Task& t) { t.machine.modes[m].residual_max = 2.0; }});
  }
  for (std::size_t j = 0; j < task.corners.size(); ++j) {
    if (task.corners[j].error_max) {
      all.push_back({"corner error " + task.corners[j].name, [j](Task& t) { t.corners[j].error_max.reset(); }});
    }
    if (task.corners[j].speed_min > 0.0) {
      all.push_back({"smallest speed " + task.corners[j].name, [j](Task& t) { t.corners[j].speed_min = 0.0; }});
    }
    if (task.corners[j].delay) {
      all.push_back({"delay of corner " + task.corners[j].name, [j](Task& t) { t.corners[j].delay.reset(); }});
    }
  }
  return all;
}

}  // namespace

std::string conflict_message(const Task& task, const std::function<bool()>& stop) {
  Task left = task;
  std::vector<std::string> conflict;
  bool minimal = true;
  for (const Droppable& limit : limits_of(task)) {
    Task without = left;
    limit.drop(without);
    if (stop()) minimal = false;
    if (!stop() && Search(without, stop).below(std::numeric_limits<double>::infinity()) == Search::Answer::proved) {
      left = without;
    } else {
      conflict.push_back(limit.name);
    }
  }
  return fmt::format("no filter of order {} or less holds together: {}{}", task.design.order_max,
                     fmt::join(conflict, ", "), minimal ? "" : " (perhaps not all of them needed)");
}

}  // namespace accdec::exact
