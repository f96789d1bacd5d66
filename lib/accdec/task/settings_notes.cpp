#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include <accdec/machine/response.hpp>
#include <accdec/task/delay_kinds.hpp>
#include <accdec/task/objective.hpp>
#include <accdec/task/pole_rest.hpp>
#include <accdec/task/settings_notes.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

constexpr double rounding = 1.0 + 1e-9;

/// Whether a stage has no longer time than this one, samples.
bool is_longest(const SettableStage& stage, double length, double period) {
  if (!stage.length_set.empty()) return length * period * rounding >= stage.length_set.back();
  const double step = stage.length_step > 0.0 ? stage.length_step : period;
  return stage.length_max > 0.0 && length * period + step > stage.length_max * rounding;
}

/// The next longer time of a stage, samples.
double next_longer(const SettableStage& stage, double length, double period) {
  if (stage.length_set.empty()) return length + std::max(1.0, stage.length_step / period);
  return *std::ranges::upper_bound(stage.length_set, length * period * rounding) / period;
}

/// Whether the filter has no room for a pole of the next longer time.
bool leaves_no_room(const Task& task, const SettableStage& stage, double length) {
  if (is_longest(stage, length, task.sample_period)) return false;
  const double taps = -std::log(pole_rest) * next_longer(stage, length, task.sample_period);
  return std::ceil(taps / rounding) > task.design.order_max + 1.0;
}

std::string order_cap(const Task& task, std::string_view what) {
  return fmt::format(" The {} is the longest that `order_max` = {} allows; longer ones were not looked at.", what,
                     task.design.order_max);
}

/// Whether a filter of this order may take less time than the result: it does with the shortest delays that the control
/// has.
bool may_be_faster(const DesignResult& result, int order) {
  const Task& task = result.task;
  const auto& kinds = task.settings->delays;
  const bool stops = std::ranges::all_of(kinds, [](DelayKind kind) { return kind == DelayKind::exact_stop; });
  std::vector<int> delays;
  for (const TaskCorner& corner : task.corners)
    delays.push_back(corner.delay.value_or(stops && !kinds.empty() ? order : 0));
  return objective_time(task, order, delays) * rounding < result.objective();
}

}  // namespace

std::string caps_reached(const DesignResult& result) {
  if (!result.settings || result.settings->family == SettingFamily::taps) return "";
  const Task& task = result.task;
  const ChosenSettings& chosen = *result.settings;
  const double period = task.sample_period;
  std::string text;
  const int order = result.filter->order();
  if (order == task.design.order_max && may_be_faster(result, order + 1)) text += order_cap(task, "filter");
  if (chosen.family == SettingFamily::exponential && chosen.values.size() > 1) {
    const double given = task.settings->time_constant_step, step = given > 0.0 ? given : period;
    if (1e-3 * chosen.values.back().value + step > (task.design.order_max + 1.0) * period * rounding)
      text += order_cap(task, "time constant");
  }
  const auto& stages = task.settings->stages;
  const auto on = [](const Setting& setting) { return setting.unit != "Hz" && setting.value > 0.0; };
  const bool one = std::count_if(chosen.values.begin(), chosen.values.end(), on) == 1;
  for (std::size_t s = 0; s < std::min(stages.size(), chosen.values.size()); ++s) {
    const Setting& setting = chosen.values[s];
    if (!on(setting)) continue;
    const double length = setting.value * stages[s].unit_seconds / period;
    if (chosen.family == SettingFamily::one_pole && one && leaves_no_room(task, stages[s], length) &&
        may_be_faster(result, task.design.order_max + 1))
      text += order_cap(task, "pole");
    if (is_longest(stages[s], length, period) && may_be_faster(result, static_cast<int>(std::lround(length))))
      text += fmt::format(" {:.9g} {}{} is the longest time that can be set.", setting.value, setting.unit,
                          setting.name.empty() ? "" : " of " + setting.name);
  }
  return text;
}

std::string exact_stop_rule(const ControllerSettings* control) {
  if (control == nullptr || control->any_delay() || !control->names(DelayKind::exact_stop)) return "";
  return "an exact stop lasts until the filter is empty, or a sample longer where a limit asks";
}

std::string stops_considered(const ControllerSettings* control) {
  const std::string rule = exact_stop_rule(control);
  return rule.empty() ? "" : " A" + rule.substr(1) + ". Longer ones are not considered.";
}

std::string limit_broken_today(const DesignResult& result) {
  const Task& task = result.task;
  if (!result.settings || result.savings || !task.baseline) return "";
  const Filter today = make_filter(*task.baseline);
  const Response response(task.machine, task.sample_period);
  const auto broken = [&](int open) {
    std::vector<int> delays;
    for (const TaskCorner& corner : task.corners) delays.push_back(corner.delay.value_or(open));
    const VerificationReport report = verify_by_simulation(task, today, delays);
    return report.feasible ? "" : report.worst;
  };
  const auto text = [](const char* delay, const std::string& limit) {
    return fmt::format(" Today's setting breaks a limit {}: {}.", delay, limit);
  };
  constexpr int apart = 2;  // samples behind the last one that moves
  if (const std::string limit = broken(today.order() + response.order() + apart); !limit.empty())
    return text("with any delay", limit);
  const ControllerSettings& control = *task.settings;
  if (control.any_delay() || control.names(DelayKind::in_position)) return "";
  const bool stops = control.names(DelayKind::exact_stop);
  const std::string limit = broken(stops ? exact_stop_delay(response.command(today)) + exact_stop_more : 0);
  return limit.empty() ? "" : text(stops ? "with exact stops" : "without delay", limit);
}

}  // namespace accdec
