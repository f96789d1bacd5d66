#include <algorithm>
#include <variant>

#include <fmt/format.h>

#include <accdec/filter.hpp>
#include <accdec/formats/force_speed_table.hpp>
#include <accdec/formats/mode_table.hpp>
#include <accdec/formats/response_table.hpp>
#include <accdec/formats/rotary_table.hpp>
#include <accdec/formats/settings_table.hpp>
#include <accdec/formats/task_keys.hpp>
#include <accdec/machine/limits.hpp>
#include <accdec/task.hpp>
#include <accdec/task/objective.hpp>

namespace accdec {
namespace {

using task_keys::axes_limit, task_keys::delay_limit, task_keys::order_limit;

constexpr Range orders{0, order_limit};

Key parameter_key(const ShapeInfo& shape) {
  const ShapeParameter& p = *shape.parameter;
  Key key{.name = std::string(p.key), .range = {p.low, p.high, p.open_low}};
  const bool whole_list = std::holds_alternative<std::vector<int> FilterSpec::*>(p.member);
  if (std::holds_alternative<int FilterSpec::*>(p.member)) key.type = KeyType::integer;
  if (whole_list || std::holds_alternative<std::vector<double> FilterSpec::*>(p.member)) {
    key.type = KeyType::numbers;
    key.most = static_cast<std::size_t>(order_limit) + 1;
    key.whole = whole_list;
  }
  switch (shape.shape) {
    case Shape::trapezoid: key.unit = "taps", key.meaning = "number of taps in each ramp", key.example = "8"; break;
    case Shape::averages:
      key.unit = "taps", key.meaning = "length of each moving average", key.example = "[20, 8]";
      break;
    case Shape::blackman_sinc:
      key.unit = "of Nyquist", key.meaning = "cutoff frequency; at most 2 / order", key.example = "0.049";
      break;
    case Shape::gaussian:
      key.meaning = "half width of the filter over its standard deviation", key.example = "2.5";
      break;
    case Shape::exponential:
      key.meaning = "each tap divided by the one before; above 1 the taps rise", key.example = "0.9";
      break;
    case Shape::taps: key.meaning = "N + 1 numbers; they are scaled to sum 1", key.example = "[1, 2, 1]"; break;
    default: key.meaning = "parameter of this kind";
  }
  key.meaning = fmt::format("{}: {}", shape.name, key.meaning);
  return key;
}

/// The keys that each kind of filter needs and those it does not take, for the JSON Schema.
std::string filter_conditions() {
  std::string text;
  for (const ShapeInfo& shape : shape_list()) {
    std::string needs, bars;
    if (shape.has_order) needs += "\"order\"";
    if (shape.parameter) needs += fmt::format("{}\"{}\"", needs.empty() ? "" : ", ", shape.parameter->key);
    for (const ShapeInfo& other : shape_list()) {
      if (other.shape != shape.shape && other.parameter)
        bars += fmt::format("{}\"{}\": false", bars.empty() ? "" : ", ", other.parameter->key);
    }
    text += fmt::format(R"({}{{"if": {{"properties": {{"kind": {{"const": "{}"}}}}}}, )"
                        R"("then": {{"required": [{}], "properties": {{{}}}}}}})",
                        text.empty() ? "" : ", ", shape.name, needs, bars);
  }
  return R"({"allOf": [)" + text +
         R"(], "dependentRequired": {"shaper": ["shaper_delay"], "shaper_delay": ["shaper"]}})";
}

std::vector<Key> make_filter_keys() {
  std::vector<std::string> kinds;
  for (const ShapeInfo& shape : shape_list()) kinds.emplace_back(shape.name);
  std::vector<Key> keys{{.name = "kind",
                         .type = KeyType::word,
                         .meaning = "shape of the taps",
                         .words = kinds,
                         .example = "\"trapezoid\"",
                         .required = true},
                        {.name = "order",
                         .type = KeyType::integer,
                         .meaning = "order N; for averages and taps it follows from their parameters",
                         .unit = "taps less 1",
                         .range = orders,
                         .example = "40"}};
  for (const ShapeInfo& shape : shape_list()) {
    if (shape.parameter) keys.push_back(parameter_key(shape));
  }
  keys.push_back({.name = "shaper",
                  .type = KeyType::word,
                  .meaning = "input shaper after the taps: two impulses (`zv`) or three (`zvd`, `mzv`, `ei`)",
                  .words = {"zv", "zvd", "mzv", "ei"},
                  .fallback = "no shaper",
                  .example = "\"zv\""});
  keys.push_back({.name = "shaper_delay",
                  .meaning = "delay from each impulse to the next, whole or not; needed with `shaper`",
                  .unit = "samples",
                  .range = {1, order_limit},
                  .example = "12"});
  return keys;
}

std::vector<Key> design_keys() {
  const DesignBounds bounds;
  std::vector<Key> keys{
      {.name = "order_min",
       .type = KeyType::integer,
       .meaning = "smallest order N to consider",
       .unit = "taps less 1",
       .range = orders,
       .fallback = fmt::format("{}", bounds.order_min),
       .example = "10"},
      {.name = "order_max",
       .type = KeyType::integer,
       .meaning = "largest order N to consider",
       .unit = "taps less 1",
       .range = orders,
       .fallback = fmt::format("{}", bounds.order_max),
       .example = "1000"},
      {.name = "symmetric",
       .type = KeyType::boolean,
       .meaning = "symmetric taps only",
       .fallback = bounds.symmetric ? "true" : "false",
       .example = "true"},
      {.name = "objective",
       .type = KeyType::word,
       .meaning = "`cycle`: sum of weight * d * T + runs (N + 1) T, what a machine spends; `corner`: sum of weight "
                  "* (N + 1 + d) T",
       .words = {std::string(to_string(Objective::cycle)), std::string(to_string(Objective::corner))},
       .fallback = std::string(to_string(bounds.objective)),
       .example = "\"corner\""},
      {.name = "runs",
       .meaning = "number of runs from rest to rest in which the corners are passed",
       .range = {0.0, 1e9, true},
       .fallback = fmt::format("{}", bounds.runs),
       .example = "5"},
      {.name = "coefficient_bits",
       .type = KeyType::integer,
       .meaning = "taps as a control stores them: whole numbers over 2^bits, rounded under all limits",
       .unit = "bits",
       .range = {8, 31},
       .fallback = "any taps",
       .example = "16"}};
  for (Key& key : setting_keys()) keys.push_back(std::move(key));
  return keys;
}

std::string limit_meaning(LimitKind kind) {
  switch (kind) {
    case LimitKind::jerk: return "largest jerk: change of the acceleration from sample to sample, over T";
    case LimitKind::force: return "largest force m a + c v + dry friction; needs mass or damping";
    case LimitKind::power: return "largest motoring power F v; needs mass, damping or dry friction";
    case LimitKind::regeneration: return "largest braking power -F v; needs mass or damping";
    case LimitKind::power_total: return "largest motoring power, the sum of F v over all axes at a sample";
    case LimitKind::regeneration_total: return "largest braking power, minus that sum";
    default: return fmt::format("largest {}", to_string(kind));
  }
}

Key limit_key(std::string_view name, LimitKind kind, double most) {
  return {.name = std::string(name),
          .meaning = limit_meaning(kind),
          .unit = std::string(limit_name(kind).unit),
          .range = {0.0, most, true},
          .fallback = "no limit",
          .example = "500"};
}

/// The limits of the table of limits; the plant stands between those that need it and those that do not.
std::vector<Key> axis_keys() {
  std::vector<Key> keys{{.name = "name",
                         .type = KeyType::text,
                         .meaning = "name of the axis; one [[axis]] alone applies to every axis",
                         .fallback = "x, y, z, ..",
                         .example = "\"x\""}};
  const auto add_limits = [&](bool load) {
    for (const AxisLimit& limit : axis_limits) {
      if (limit.load != load || limit.key == force_speed_key) continue;
      keys.push_back(limit_key(limit.key, limit.kind, limit.key_max));
    }
  };
  add_limits(false);
  keys.push_back({.name = "mass_kg",
                  .meaning = "moved mass m in F = m a + c v",
                  .unit = "kg",
                  .range = {0.0, 1e6},
                  .fallback = "0",
                  .example = "50"});
  keys.push_back({.name = "damping_N_s_m",
                  .meaning = "viscous friction c in F = m a + c v",
                  .unit = "N s/m",
                  .range = {0.0, 1e8},
                  .fallback = "0",
                  .example = "800"});
  keys.push_back({.name = "coulomb_N",
                  .meaning = "dry friction against the motion; at rest up to as much, in the direction that helps",
                  .unit = "N",
                  .range = {0.0, 1e8},
                  .fallback = "0",
                  .example = "40"});
  add_limits(true);
  keys.push_back(force_speed_of_files());
  keys.push_back({.name = "force_rms_N",
                  .meaning = "rating of the drive: root mean square of the force over a whole program, dwells and the "
                             "servo's last motion included",
                  .unit = "N",
                  .range = {0.0, 1e8, true},
                  .fallback = "no limit",
                  .example = "260"});
  for (Key& key : servo_keys()) keys.push_back(std::move(key));
  for (Key& key : rotary_keys()) keys.push_back(std::move(key));
  keys.push_back(torque_speed_of_files());
  return keys;
}

Key direction(std::string name, std::string meaning, std::string example) {
  return {.name = std::move(name),
          .type = KeyType::numbers,
          .meaning = std::move(meaning),
          .range = {-1e9, 1e9},
          .most = axes_limit,
          .example = std::move(example),
          .per_axis = true};
}

Key feed(std::string name, std::string meaning, std::string fallback) {
  return {.name = std::move(name),
          .meaning = std::move(meaning),
          .unit = "mm/min",
          .range = {0.0, 1e7, true},
          .fallback = std::move(fallback),
          .example = "6000"};
}

Key error_max(std::string meaning) {
  return {.name = "error_max_um",
          .meaning = std::move(meaning),
          .unit = "um",
          .range = {0.0, 1e7},
          .fallback = "no bound",
          .example = "50"};
}

Key contour_max(std::string meaning) {
  return {.name = "contour_max_um",
          .meaning = std::move(meaning),
          .unit = "um",
          .range = {0.0, 1e7},
          .fallback = "no bound",
          .example = "30"};
}

std::vector<Key> corner_keys() {
  std::vector<Key> keys{
      {.name = "name",
       .type = KeyType::text,
       .meaning = "unique name of the corner",
       .fallback = "A, B, ..",
       .example = "\"A\""},
      {.name = "angle_deg",
       .meaning = "interior angle; 180 is straight on",
       .unit = "degrees",
       .range = {0.0, 180.0, true},
       .example = "95",
       .allowed = "allowed is 0 < angle_deg <= 180; or `direction_in` and `direction_out`"},
      {.name = "heading_deg",
       .meaning = "travel direction on leg 1, from +x towards +y",
       .unit = "degrees",
       .range = {-360.0, 360.0},
       .fallback = "0",
       .example = "30"},
      {.name = "turn",
       .type = KeyType::word,
       .meaning = "side to which the path turns",
       .words = {"left", "right"},
       .fallback = "left",
       .example = "\"right\""},
      direction("direction_in", "direction of leg 1, one number per axis; instead of angle, heading and turn",
                "[1, 0, 0]"),
      direction("direction_out", "direction of leg 2, one number per axis; with `direction_in`", "[0, 1, 1]"),
      feed("feed_in_mm_min", "feed on leg 1", ""),
      feed("feed_out_mm_min", "feed on leg 2", "that of leg 1"),
      error_max("tolerance of the corner"),
      contour_max("largest distance of the path from the two programmed legs"),
      {.name = "speed_min_mm_s",
       .meaning = "smallest tangential speed",
       .unit = "mm/s",
       .range = {0.0, 1e6},
       .fallback = "0",
       .example = "20"},
      {.name = "delay_samples",
       .type = KeyType::integer,
       .meaning = "delay d of leg 2",
       .unit = "samples",
       .range = {0, delay_limit},
       .fallback = "chosen",
       .example = "12"},
      {.name = "weight",
       .meaning = "how often the corner occurs",
       .range = {0.0, 1e9, true},
       .fallback = "1",
       .example = "40"}};
  for (Key& key : keys) key.required = key.name == "feed_in_mm_min";
  return keys;
}

/// Limits of all axes together.
std::vector<Key> machine_keys() {
  std::vector<Key> keys;
  for (const SupplyLimit& limit : supply_limits) keys.push_back(limit_key(limit.key, limit.kind, 1e8));
  return keys;
}

Key filter_table(std::string name, std::string meaning) {
  return {.name = std::move(name),
          .type = KeyType::table,
          .meaning = std::move(meaning),
          .keys = filter_keys(),
          .conditions = filter_conditions()};
}

FileKind make_task_file() {
  FileKind file{.name = "task", .title = "accdec task"};
  file.keys = {{.name = "title",
                .type = KeyType::text,
                .meaning = "heading of results",
                .example = "\"One corner\"",
                .empty_text = true,
                .long_text = true},
               {.name = "sample_period_ms",
                .meaning = "period T of the command",
                .unit = "ms",
                .range = {1e-4, 1e3},
                .example = "1",
                .required = true},
               filter_table("filter", "the filter; without it, taps are designed"),
               filter_table("baseline", "the filter that the machine has today, to compare the design with"),
               {.name = "design",
                .type = KeyType::table,
                .meaning = "bounds on what the design may choose",
                .keys = design_keys()},
               {.name = "controller",
                .type = KeyType::table,
                .meaning = "the control that runs the design",
                .keys = controller_keys()},
               {.name = "machine",
                .type = KeyType::table,
                .meaning = "limits of the supply that all axes share",
                .keys = machine_keys()},
               tables_key("axis", "limits and load of an axis; without any, axes x and y have no limits", axis_keys()),
               tables_key("corner", "a corner of the path", corner_keys()),
               {.name = "mode",
                .type = KeyType::tables,
                .meaning = "a vibration that the filter must not excite",
                .keys = mode_keys(),
                .conditions = mode_conditions()},
               {.name = "program",
                .type = KeyType::table,
                .meaning = "values that a program does not give",
                .keys = {error_max("tolerance of corners for which the program gives none"),
                         contour_max("largest distance of the motion from the moves, chords of arcs included")}}};
  Key& corner = *std::find_if(file.keys.begin(), file.keys.end(), [](const Key& key) { return key.name == "corner"; });
  corner.conditions =
      R"({"oneOf": [{"required": ["angle_deg"], "properties": {"direction_in": false, "direction_out": false}}, )"
      R"({"required": ["direction_in", "direction_out"], )"
      R"("properties": {"angle_deg": false, "heading_deg": false, "turn": false}}]})";
  return file;
}

}  // namespace

const std::vector<Key>& filter_keys() {
  static const std::vector<Key> keys = make_filter_keys();
  return keys;
}

const FileKind& task_file() {
  static const FileKind file = make_task_file();
  return file;
}

}  // namespace accdec
