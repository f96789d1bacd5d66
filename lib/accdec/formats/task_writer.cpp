#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <accdec/formats/filter_table.hpp>
#include <accdec/formats/force_speed_table.hpp>
#include <accdec/formats/rotary_table.hpp>
#include <accdec/formats/settings_table.hpp>
#include <accdec/formats/task_keys.hpp>
#include <accdec/formats/task_writer.hpp>
#include <accdec/machine/limits.hpp>
#include <accdec/task/objective.hpp>

namespace accdec {
namespace {

using Json = nlohmann::ordered_json;

/// A table of a task under construction. It knows its possible keys, their units and their order.
class Written {
 public:
  explicit Written(const std::vector<Key>& keys) : keys_(keys), values_(keys.size()) {}
  /// The table of that name in a task.
  explicit Written(std::string_view table) : Written(find_key(task_file().keys, table)->keys) {}

  void number(std::string_view name, double si) { at(name) = from_si(key(name), si); }
  void value(std::string_view name, Json json) { at(name) = std::move(json); }

  /// The table in the order of the keys. It is empty afterwards.
  Json json() {
    Json::object_t table;
    for (std::size_t i = 0; i < keys_.size(); ++i) {
      if (!values_[i].is_null()) table.emplace_back(keys_[i].name, std::move(values_[i]));
    }
    return table;
  }

 private:
  const Key& key(std::string_view name) const {
    if (const Key* found = find_key(keys_, name)) return *found;
    throw std::logic_error(fmt::format("a task has no key `{}` there", name));
  }
  Json& at(std::string_view name) { return values_[static_cast<std::size_t>(&key(name) - keys_.data())]; }

  const std::vector<Key>& keys_;
  std::vector<Json> values_;  // as keys_; null if there is no value
};

Json axis_json(const Axis& axis) {
  Written table("axis");
  const auto key = [&](std::string_view name) { return is_rotary(axis.name) ? rotary_key(name) : name; };
  table.value("name", axis.name);
  if (axis.mass > 0.0) table.number(key("mass_kg"), axis.mass);
  if (axis.damping > 0.0) table.number(key("damping_N_s_m"), axis.damping);
  if (axis.coulomb > 0.0) table.number(key("coulomb_N"), axis.coulomb);
  for (const AxisLimit& limit : axis_limits) {
    if (axis.*limit.bound < unlimited && limit.key != force_speed_key) table.number(key(limit.key), axis.*limit.bound);
  }
  if (const std::string_view curve = key(force_speed_key); axis.force_speed_max < unlimited)
    table.value(curve, curve_of_files(curve, axis));
  if (axis.force_rms_max < unlimited) table.number(key("force_rms_N"), axis.force_rms_max);
  if (axis.servo_gain < unlimited) {
    table.number("servo_gain_1_s", axis.servo_gain);
    if (axis.velocity_feedforward > 0.0) table.number("velocity_feedforward", axis.velocity_feedforward);
  }
  if (!axis.response_taps.empty()) table.value("response_taps", axis.response_taps);
  return table.json();
}

Json machine_json(const Machine& machine) {
  Written table("machine");
  for (const SupplyLimit& limit : supply_limits) {
    if (machine.*limit.bound < unlimited) table.number(limit.key, machine.*limit.bound);
  }
  return table.json();
}

Json task_corner_json(const TaskCorner& corner) {
  Written table("corner");
  table.value("name", corner.name);
  if (const auto* planar = std::get_if<PlanarLegs>(&corner.legs())) {
    table.number("angle_deg", planar->angle);
    table.number("heading_deg", planar->heading);
    table.value("turn", planar->turn == Turn::left ? "left" : "right");
  } else {
    const auto& directed = std::get<DirectedLegs>(corner.legs());
    table.value("direction_in", directed.in);
    table.value("direction_out", directed.out);
  }
  table.number("feed_in_mm_min", corner.geometry().feed_in);
  table.number("feed_out_mm_min", corner.geometry().feed_out);
  if (corner.error_max) table.number("error_max_um", *corner.error_max);
  if (corner.contour_max) table.number("contour_max_um", *corner.contour_max);
  if (corner.speed_min > 0.0) table.number("speed_min_mm_s", corner.speed_min);
  if (corner.delay) table.value("delay_samples", *corner.delay);
  table.number("weight", corner.weight);
  return table.json();
}

Json mode_json(const Mode& mode, const std::vector<Axis>& axes) {
  Written table("mode");
  if (mode.frequency_low == mode.frequency_high)
    table.value("frequency_Hz", mode.frequency_low);
  else
    table.value("frequency_Hz", {mode.frequency_low, mode.frequency_high});
  if (mode.damping_high > 0.0) {
    if (mode.damping_low == mode.damping_high)
      table.value("damping_ratio", mode.damping_low);
    else
      table.value("damping_ratio", {mode.damping_low, mode.damping_high});
  }
  if (mode.of_axis()) {
    table.value("axis", axes[static_cast<std::size_t>(mode.axis)].name);
    table.number("residual_max_um", mode.displacement_max);
  } else {
    table.number("residual_max", mode.residual_max);
  }
  return table.json();
}

Json design_json(const DesignBounds& design) {
  Written table("design");
  table.value("order_min", design.order_min);
  table.value("order_max", design.order_max);
  table.value("symmetric", design.symmetric);
  table.value("objective", to_string(design.objective));
  table.number("runs", design.runs);
  if (design.coefficient_bits > 0) table.value("coefficient_bits", design.coefficient_bits);
  return table.json();
}

void write_table(std::string& out, const std::string& header, const Json& table) {
  out += "\n" + header + "\n";
  // JSON scalars, strings and arrays of numbers are valid TOML without change.
  for (const auto& [key, value] : table.items()) out += fmt::format("{} = {}\n", key, value.dump());
}

}  // namespace

nlohmann::ordered_json task_to_json(const Task& task) {
  Written top(task_file().keys);
  const auto list = [&](std::string_view name, const auto& parts, auto json_of) {
    Json all = Json::array();
    for (const auto& part : parts) all.push_back(json_of(part));
    if (!all.empty()) top.value(name, std::move(all));
  };
  top.value("title", task.title);
  top.number("sample_period_ms", task.sample_period);
  if (task.filter) top.value("filter", filter_to_json(*task.filter));
  if (task.baseline) top.value("baseline", filter_to_json(*task.baseline));
  Json design = design_json(task.design), controller;
  if (task.settings) write_settings(task, design, controller);
  if (!task.machine.prefilter_taps.empty()) controller["prefilter_taps"] = task.machine.prefilter_taps;
  if (task.machine.position_unit > 0.0) {
    Written unit("controller");
    unit.number("position_unit_um", task.machine.position_unit);
    controller.update(unit.json());
  }
  top.value("design", std::move(design));
  if (!controller.is_null()) top.value("controller", std::move(controller));
  if (limits_supply(task.machine)) top.value("machine", machine_json(task.machine));
  list("axis", task.machine.axes, axis_json);
  list("corner", task.corners, task_corner_json);
  list("mode", task.machine.modes, [&](const Mode& mode) { return mode_json(mode, task.machine.axes); });
  if (task.program_error_max || task.program_contour_max) {
    Written program("program");
    if (task.program_error_max) program.number("error_max_um", *task.program_error_max);
    if (task.program_contour_max) program.number("contour_max_um", *task.program_contour_max);
    top.value("program", program.json());
  }
  return top.json();
}

std::string task_to_toml(const Task& task) {
  const Json json = task_to_json(task);
  std::string out;
  for (const auto& [key, value] : json.items()) {
    if (!value.is_structured()) out += fmt::format("{} = {}\n", key, value.dump());
  }
  for (const auto& [key, value] : json.items()) {
    if (value.is_object()) write_table(out, "[" + key + "]", value);
    if (!value.is_array()) continue;
    for (const Json& table : value) write_table(out, "[[" + key + "]]", table);
  }
  return out;
}

}  // namespace accdec
