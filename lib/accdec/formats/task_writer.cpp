#include <cmath>
#include <cstdlib>
#include <limits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <accdec/formats/filter_table.hpp>
#include <accdec/formats/task_keys.hpp>
#include <accdec/formats/task_writer.hpp>
#include <accdec/task/objective.hpp>

namespace accdec {

namespace task_keys {

double in_unit(const NumberKey& key, double si) {
  const double about = si / key.to_si(1.0);
  for (int digits = 1; digits <= 17; ++digits) {
    const double x = std::strtod(fmt::format("{:.{}g}", about, digits).c_str(), nullptr);
    if (key.to_si(x) == si) return x;
  }
  // The division may have been off by an ulp or two; one of the neighbours is the value that was read.
  double up = about, down = about;
  for (int step = 0; step < 8; ++step) {
    up = std::nextafter(up, std::numeric_limits<double>::infinity());
    down = std::nextafter(down, -std::numeric_limits<double>::infinity());
    if (key.to_si(up) == si) return up;
    if (key.to_si(down) == si) return down;
  }
  return about;  // no number converts to it, so it was not read from a file; next best
}

}  // namespace task_keys

namespace {

using Json = nlohmann::ordered_json;
using task_keys::NumberKey;

void put(Json& table, const NumberKey& key, double si) {
  table[std::string(key.key)] = task_keys::in_unit(key, si);
}

Json axis_json(const Axis& axis) {
  Json table;
  table["name"] = axis.name;
  for (const auto& key : task_keys::axis_keys) {
    const double value = axis.*key.member;
    const bool written = key.open_low ? value < unlimited : value > 0.0;
    if (written) put(table, key, value);
  }
  return table;
}

Json corner_json(const TaskCorner& corner) {
  Json table;
  table["name"] = corner.name;
  if (const auto* planar = std::get_if<PlanarLegs>(&corner.legs())) {
    put(table, task_keys::angle, planar->angle);
    put(table, task_keys::heading, planar->heading);
    table["turn"] = planar->turn == Turn::left ? "left" : "right";
  } else {
    const auto& directed = std::get<DirectedLegs>(corner.legs());
    table["direction_in"] = directed.in;
    table["direction_out"] = directed.out;
  }
  put(table, task_keys::feed_in, corner.geometry().feed_in);
  put(table, task_keys::feed_out, corner.geometry().feed_out);
  if (corner.error_max) put(table, task_keys::error_max, *corner.error_max);
  if (corner.speed_min > 0.0) put(table, task_keys::speed_min, corner.speed_min);
  if (corner.delay) table["delay_samples"] = *corner.delay;
  table["weight"] = corner.weight;
  return table;
}

void write_table(std::string& out, const std::string& header, const Json& table) {
  out += "\n" + header + "\n";
  // JSON scalars, strings and arrays of numbers are TOML as they stand.
  for (const auto& [key, value] : table.items()) out += fmt::format("{} = {}\n", key, value.dump());
}

}  // namespace

nlohmann::ordered_json task_to_json(const Task& task) {
  Json json;
  json["title"] = task.title;
  put(json, task_keys::sample_period, task.sample_period);
  if (task.filter) json["filter"] = filter_to_json(*task.filter);
  if (task.baseline) json["baseline"] = filter_to_json(*task.baseline);
  json["design"]["order_min"] = task.design.order_min;
  json["design"]["order_max"] = task.design.order_max;
  json["design"]["symmetric"] = task.design.symmetric;
  json["design"]["objective"] = to_string(task.design.objective);
  put(json["design"], task_keys::runs, task.design.runs);
  for (const Axis& axis : task.machine.axes) json["axis"].push_back(axis_json(axis));
  for (const TaskCorner& corner : task.corners) json["corner"].push_back(corner_json(corner));
  for (const Mode& mode : task.machine.modes) {
    Json table;
    if (mode.frequency_low == mode.frequency_high)
      table["frequency_Hz"] = mode.frequency_low;
    else
      table["frequency_Hz"] = {mode.frequency_low, mode.frequency_high};
    table["residual_max"] = mode.residual_max;
    json["mode"].push_back(std::move(table));
  }
  if (task.program_error_max) put(json["program"], task_keys::error_max, *task.program_error_max);
  return json;
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
