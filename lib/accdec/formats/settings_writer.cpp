#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <accdec/formats/settings_table.hpp>

namespace accdec {
namespace {

using Json = nlohmann::ordered_json;

void write_parameters(const ControllerSettings& settings, Json& controller) {
  if (!settings.controller.empty()) controller["title"] = settings.controller;
  for (const std::string& what : settings.assumed) controller["assumed"].push_back(what);
  const bool named = std::any_of(settings.stages.begin(), settings.stages.end(),
                                 [](const SettableStage& stage) { return !stage.name.empty(); });
  for (const SettableStage& stage : settings.stages) {
    if (!named) return;
    controller["parameters"].push_back(stage.name);
    controller["parameter_units"].push_back(stage.unit);
    controller["parameter_unit_ms"].push_back(1e3 * stage.unit_seconds);
  }
}

/// One number a stage, ms; empty if no stage has one. @param none  for a stage that has none
Json in_ms(const std::vector<SettableStage>& stages, double SettableStage::*member, double none) {
  Json list = Json::array();
  const bool any =
      std::any_of(stages.begin(), stages.end(), [&](const SettableStage& stage) { return stage.*member > 0.0; });
  for (const SettableStage& stage : stages) {
    if (any) list.push_back(from_si({.unit = "ms"}, stage.*member > 0.0 ? stage.*member : none));
  }
  return list;
}

/// All times that a stage can have in filters of the task, ms.
Json times_in_ms(const SettableStage& stage, const Task& task) {
  std::vector<double> times = stage.length_set;
  if (times.empty()) {
    const double step = stage.length_step > 0.0 ? stage.length_step : task.sample_period;
    const double longest = (task.design.order_max + 1) * task.sample_period;
    const double last = stage.length_max > 0.0 ? std::min(stage.length_max, longest) : longest;
    for (int i = 1; i * step <= last * (1.0 + 1e-9); ++i) times.push_back(std::round(1e12 * i * step) / 1e12);
  }
  Json list = Json::array();
  for (const double time : times) list.push_back(from_si({.unit = "ms"}, time));
  return list;
}

/// Sets where any stage has one, else steps and caps.
void write_times(const Task& task, Json& design) {
  const std::vector<SettableStage>& stages = task.settings->stages;
  const bool sets =
      std::any_of(stages.begin(), stages.end(), [](const SettableStage& stage) { return !stage.length_set.empty(); });
  if (!sets) {
    constexpr double no_cap = 1000.0;  // s, the largest that the key allows
    const Json steps = in_ms(stages, &SettableStage::length_step, task.sample_period),
               caps = in_ms(stages, &SettableStage::length_max, no_cap);
    if (!steps.empty()) design["length_step_ms"] = steps;
    if (!caps.empty()) design["length_max_ms"] = caps;
    return;
  }
  for (std::size_t i = 0; i < stages.size(); ++i) {
    const Json times = times_in_ms(stages[i], task);
    if (i == 0)
      design["length_set_ms"] = times;
    else if (times != design["length_set_ms"])
      design[fmt::format("length_set_{}_ms", i + 1)] = times;
  }
}

}  // namespace

void write_settings(const Task& task, Json& design, Json& controller) {
  const ControllerSettings& settings = *task.settings;
  if (settings.names_family()) {
    for (const SettingFamily family : settings.families) design["family"].push_back(to_string(family));
    design["stages"] = settings.stages.size();
    if (settings.shaper != nullptr) design["shaper"] = settings.shaper->name;
    write_times(task, design);
    for (const GridStep& grid : grid_steps) {
      const bool has =
          std::find(settings.families.begin(), settings.families.end(), grid.family) != settings.families.end();
      const Key key = *find_key(setting_keys(), grid.key);
      if (has && settings.*grid.step > 0.0) design[grid.key] = from_si(key, settings.*grid.step);
    }
  }
  for (const DelayKind kind : settings.delays) controller["delays"].push_back(to_string(kind));
  for (const std::string& word : settings.delay_words) controller["delay_words"].push_back(word);
  const bool watches = settings.names(DelayKind::in_position);
  if (settings.in_position_actual) controller["in_position_of"] = "actual";
  if (watches && settings.in_position_by_axis) controller["in_position_by"] = "axis";
  if (settings.in_position_latency > 0.0)
    controller["in_position_latency_ms"] = from_si({.unit = "ms"}, settings.in_position_latency);
  if (settings.names(DelayKind::corner_feed)) controller["corner_feed_step"] = settings.corner_feed_step;
  write_parameters(settings, controller);
}

}  // namespace accdec
