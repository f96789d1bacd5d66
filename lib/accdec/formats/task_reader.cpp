#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include <accdec/files/text_file.hpp>
#include <accdec/files/toml_table.hpp>
#include <accdec/formats/filter_table.hpp>
#include <accdec/formats/task_keys.hpp>
#include <accdec/formats/task_reader.hpp>
#include <accdec/formats/task_tree.hpp>

namespace accdec {
namespace {

using task_keys::NumberKey;
using toml_input::Range;
using toml_input::Table;

Range range_of(const NumberKey& k) {
  return {k.low, k.high, k.open_low};
}

double required(const Table& table, const NumberKey& k) {
  return k.to_si(table.required_number(k.key, range_of(k)));
}

std::optional<double> optional(const Table& table, const NumberKey& k) {
  const auto value = table.number(k.key, range_of(k));
  return value ? std::optional(k.to_si(*value)) : std::nullopt;
}

std::vector<std::string_view> axis_table_keys() {
  std::vector<std::string_view> keys{"name"};
  for (const auto& field : task_keys::axis_keys) keys.push_back(field.key);
  return keys;
}

/// Where a key that is unknown here would be right.
std::string other_table(std::string_view key) {
  const auto axis = axis_table_keys();
  if (std::find(axis.begin() + 1, axis.end(), key) != axis.end()) return fmt::format("`{}` belongs in [[axis]]", key);
  const auto filter = filter_keys();
  if (std::find(filter.begin(), filter.end(), key) != filter.end()) return fmt::format("`{}` belongs in [filter]", key);
  static const std::map<std::string_view, std::string_view> homes{{"sample_period_ms", "at the top, before any table"},
                                                                  {"title", "at the top, before any table"},
                                                                  {"order_min", "in [design]"},
                                                                  {"order_max", "in [design]"},
                                                                  {"symmetric", "in [design]"},
                                                                  {"objective", "in [design]"},
                                                                  {"runs", "in [design]"},
                                                                  {"angle_deg", "in [[corner]]"},
                                                                  {"heading_deg", "in [[corner]]"},
                                                                  {"turn", "in [[corner]]"},
                                                                  {"direction_in", "in [[corner]]"},
                                                                  {"direction_out", "in [[corner]]"},
                                                                  {"feed_in_mm_min", "in [[corner]]"},
                                                                  {"feed_out_mm_min", "in [[corner]]"},
                                                                  {"error_max_um", "in [[corner]] or [program]"},
                                                                  {"speed_min_mm_s", "in [[corner]]"},
                                                                  {"delay_samples", "in [[corner]]"},
                                                                  {"weight", "in [[corner]]"},
                                                                  {"frequency_Hz", "in [[mode]]"},
                                                                  {"residual_max", "in [[mode]]"}};
  const auto home = homes.find(key);
  return home == homes.end() ? "" : fmt::format("`{}` belongs {}", key, home->second);
}

DesignBounds read_design(const toml::table& source, const Table& top) {
  const Table table(source, top.file(), "[design]", top.pointer() + "/design",
                    {"order_min", "order_max", "symmetric", "objective", "runs"}, other_table);
  DesignBounds bounds;
  bounds.order_min = table.integer("order_min", 0, task_keys::order_limit).value_or(bounds.order_min);
  bounds.order_max = table.integer("order_max", 0, task_keys::order_limit).value_or(bounds.order_max);
  bounds.symmetric = table.boolean("symmetric").value_or(bounds.symmetric);
  constexpr std::string_view objectives[] = {"cycle", "corner"};
  if (const auto name = table.word("objective", objectives)) {
    bounds.objective = *name == "cycle" ? Objective::cycle : Objective::corner;
  }
  bounds.runs = optional(table, task_keys::runs).value_or(bounds.runs);
  if (bounds.order_min > bounds.order_max) {
    table.fail_at(
        table.has("order_min") ? "order_min" : "order_max",
        fmt::format("`order_min` = {} is above `order_max` = {}{}; allowed is order_min <= order_max", bounds.order_min,
                    bounds.order_max, table.has("order_max") && table.has("order_min") ? "" : " (the default counts)"));
  }
  return bounds;
}

Axis read_axis(const Table& table) {
  Axis axis;
  axis.name = table.text("name").value_or("");
  for (const auto& field : task_keys::axis_keys) {
    if (const auto value = optional(table, field)) axis.*field.member = *value;
  }
  for (const AxisLimit& limit : axis_limits) {
    if (limit.load && table.has(limit.key) && axis.mass == 0.0 && axis.damping == 0.0) {
      table.fail_at(limit.key, fmt::format("`{}` can never bind: force is mass * acceleration + damping * velocity; "
                                           "give mass_kg or damping_N_s_m",
                                           limit.key));
    }
  }
  return axis;
}

/// Gives the first two names taken alike as an error.
class Names {
 public:
  void add(const Table& table, const std::string& name) {
    if (const auto [it, fresh] = seen_.emplace(name, table.place("name")); !fresh) {
      table.fail_at("name", fmt::format("the name \"{}\" is taken already ({}); names must differ", name, it->second));
    }
  }

 private:
  std::map<std::string, std::string> seen_;
};

Mode read_mode(const Table& table) {
  Mode mode;
  const auto& key = task_keys::frequency;
  const auto band = table.numbers(key.key, range_of(key), 1, 2, true);
  if (!band) table.fail("[[mode]] needs `frequency_Hz`; allowed is one number or a band [low, high]");
  mode.frequency_low = band->front();
  mode.frequency_high = band->back();
  if (mode.frequency_low > mode.frequency_high) {
    table.fail_at(key.key, fmt::format("`frequency_Hz` = [{}, {}] runs downwards; allowed is [low, high]",
                                       mode.frequency_low, mode.frequency_high));
  }
  mode.residual_max = required(table, task_keys::residual_max);
  return mode;
}

/// A, B, ..., Z, AA, AB, ...
std::string letters(std::size_t i) {
  std::string name;
  for (++i; i > 0; i = (i - 1) / 26) name.insert(name.begin(), static_cast<char>('A' + (i - 1) % 26));
  return name;
}

std::string name_of(const Table& table, std::size_t index) {
  return table.text("name").value_or(letters(index));
}

DirectedLegs read_directions(const Table& table) {
  for (const std::string_view key : {"angle_deg", "heading_deg", "turn"}) {
    if (table.has(key))
      table.fail_at(key, fmt::format("`{}` and leg directions are both given; allowed is either angle_deg, "
                                     "heading_deg, turn or direction_in, direction_out",
                                     key));
  }
  const Range component{-1e9, 1e9};
  const auto in = table.numbers("direction_in", component, 1, task_keys::axes_limit);
  const auto out = table.numbers("direction_out", component, 1, task_keys::axes_limit);
  if (!in || !out)
    table.fail(fmt::format("[[corner]] needs `{}` as well; allowed are both directions, one number an axis",
                           in ? "direction_out" : "direction_in"));
  if (in->size() != out->size()) {
    table.fail_at("direction_out",
                  fmt::format("`direction_out` has {} numbers, `direction_in` {}; both need one an axis", out->size(),
                              in->size()));
  }
  for (const std::string_view key : {"direction_in", "direction_out"}) {
    const auto& direction = key == "direction_in" ? *in : *out;
    if (std::all_of(direction.begin(), direction.end(), [](double x) { return x == 0.0; })) {
      table.fail_at(key, fmt::format("`{}` is zero in every axis; a leg needs a direction", key));
    }
  }
  return {*in, *out};
}

CornerLegs read_legs(const Table& table) {
  if (table.has("direction_in") || table.has("direction_out")) return read_directions(table);
  if (!table.has("angle_deg"))
    table.fail("[[corner]] needs `angle_deg`, allowed is 0 < angle_deg <= 180; or `direction_in` and `direction_out`");
  constexpr std::string_view turns[] = {"left", "right"};
  return PlanarLegs{required(table, task_keys::angle), optional(table, task_keys::heading).value_or(0.0),
                    table.word("turn", turns).value_or("left") == "left" ? Turn::left : Turn::right};
}

TaskCorner make_task_corner(const Table& table, const std::string& name, const CornerLegs& legs, std::size_t axes) {
  if (std::holds_alternative<PlanarLegs>(legs) && axes < 2)
    table.fail_at("angle_deg", "`angle_deg` needs at least 2 axes; with one axis give direction_in and direction_out");
  const double feed_in = required(table, task_keys::feed_in);
  const double feed_out = optional(table, task_keys::feed_out).value_or(feed_in);
  try {
    return TaskCorner(name, legs, feed_in, feed_out, static_cast<int>(axes));
  } catch (const std::invalid_argument& error) {
    table.fail(error.what());
  }
}

TaskCorner read_corner(const Table& table, const std::string& name, const CornerLegs& legs, std::size_t axes) {
  TaskCorner corner = make_task_corner(table, name, legs, axes);
  corner.error_max = optional(table, task_keys::error_max);
  corner.speed_min = optional(table, task_keys::speed_min).value_or(0.0);
  corner.delay = table.integer("delay_samples", 0, task_keys::delay_limit);
  corner.weight = optional(table, task_keys::weight).value_or(1.0);
  return corner;
}

/// How many numbers a leg direction has; 0 for legs in the plane.
std::size_t components(const CornerLegs& legs) {
  const auto* directed = std::get_if<DirectedLegs>(&legs);
  return directed ? directed->in.size() : 0;
}

/// How many axes there are, when not one table an axis says so: as many as the leg directions have.
std::size_t count_axes(const std::vector<CornerLegs>& corners, const std::vector<Table>& tables,
                       const TaskOptions& options) {
  std::size_t count = 0, from = 0;
  for (std::size_t j = 0; j < corners.size(); ++j) {
    const std::size_t n = components(corners[j]);
    if (n == 0) continue;
    if (count != 0 && n != count) {
      tables[j].fail_at("direction_in",
                        fmt::format("`direction_in` has {} numbers, that of corner {} has {}; all need one an axis", n,
                                    name_of(tables[from], from), count));
    }
    if (count == 0) count = n, from = j;
  }
  return count != 0 ? count : static_cast<std::size_t>(options.axes);
}

std::vector<Axis> read_axes(const std::vector<Table>& tables, const std::vector<CornerLegs>& corners,
                            const std::vector<Table>& corner_tables, const TaskOptions& options) {
  std::vector<Axis> axes;
  if (tables.size() > task_keys::axes_limit)
    tables.back().fail(fmt::format("{} [[axis]] tables; at most {} are allowed", tables.size(), task_keys::axes_limit));
  if (tables.size() < 2) {
    const Axis model = tables.empty() ? Axis{} : read_axis(tables.front());
    const std::size_t count = count_axes(corners, corner_tables, options);
    for (std::size_t i = 0; i < count; ++i) {
      axes.push_back(model);
      // The table stands for all axes, so its name names none, unless there is only one.
      if (count > 1 || model.name.empty()) axes.back().name = task_keys::axis_names[i];
    }
    return axes;
  }
  Names names;
  for (std::size_t i = 0; i < tables.size(); ++i) {
    axes.push_back(read_axis(tables[i]));
    if (axes.back().name.empty()) axes.back().name = task_keys::axis_names[i];
    names.add(tables[i], axes.back().name);
  }
  for (std::size_t j = 0; j < corners.size(); ++j) {
    const std::size_t n = components(corners[j]);
    if (n != 0 && n != axes.size()) {
      corner_tables[j].fail_at(
          "direction_in",
          fmt::format("`direction_in` has {} numbers for {} axes; one an axis is needed", n, axes.size()));
    }
  }
  return axes;
}

/// A leg that asks an axis for more than its velocity.
void check_feeds(const TaskCorner& corner, const Table& table, const Machine& machine) {
  const Corner& legs = corner.geometry();
  for (Eigen::Index a = 0; a < legs.axes(); ++a) {
    const Axis& axis = machine.axes[static_cast<std::size_t>(a)];
    const auto check = [&](const NumberKey& key, double feed, double part) {
      // The last factor leaves room for the rounding of sqrt(1/2) and its like.
      if (feed * std::abs(part) <= axis.velocity_max * (1.0 + 1e-12)) return;
      table.fail_at(table.has(key.key) ? key.key : task_keys::feed_in.key,
                    fmt::format("corner {}: {} asks axis {} for {:.6g} mm/s; allowed is velocity_max_mm_s = {:.6g} (a "
                                "feed up to {:.6g} mm/min in this direction)",
                                corner.name, key.key, axis.name, 1e3 * feed * std::abs(part), 1e3 * axis.velocity_max,
                                6e4 * axis.velocity_max / std::abs(part)));
    };
    check(task_keys::feed_in, legs.feed_in, legs.direction_in[a]);
    check(task_keys::feed_out, legs.feed_out, legs.direction_out[a]);
  }
}

std::vector<Table> read_tables(const Table& top, std::string_view key, const std::vector<std::string_view>& keys) {
  std::vector<Table> result;
  for (const toml::table* table : top.tables(key)) {
    const std::size_t i = result.size();
    result.emplace_back(*table, top.file(), fmt::format("[[{}]] {}", key, i + 1),
                        fmt::format("{}/{}/{}", top.pointer(), key, i), keys, other_table);
  }
  return result;
}

/// For commands that design nothing. Comes last: what is wrong in itself is told before what is missing for one
/// command.
void require_choices(const Task& task, const Table& top, const std::vector<Table>& corners) {
  if (!task.filter) top.fail("the task has no [filter], which is needed here; `accdec design` chooses one");
  for (std::size_t j = 0; j < corners.size(); ++j) {
    if (task.corners[j].delay) continue;
    corners[j].fail(fmt::format("corner {} has no `delay_samples`, which is needed here; `accdec design` chooses it",
                                task.corners[j].name));
  }
}

}  // namespace

Task task_from_tree(const toml::table& tree, const std::string& file, const std::string& pointer,
                    const TaskOptions& options) {
  const Table top(tree, file, "the task (top level)", pointer,
                  {"title", "sample_period_ms", "filter", "baseline", "design", "axis", "corner", "mode", "program"},
                  other_table);
  Task task;
  task.title = top.text("title", true, true).value_or("");
  task.sample_period = required(top, task_keys::sample_period);
  if (const auto* filter = top.table("filter")) task.filter = read_filter(*filter, top, "filter", other_table);
  if (const auto* given = top.table("baseline")) task.baseline = read_filter(*given, top, "baseline", other_table);
  if (const auto* design = top.table("design")) task.design = read_design(*design, top);
  if (const auto* program = top.table("program")) {
    const Table table(*program, file, "[program]", pointer + "/program", {"error_max_um"}, other_table);
    task.program_error_max = optional(table, task_keys::error_max);
  }
  const auto axes = read_tables(top, "axis", axis_table_keys());
  const auto corners =
      read_tables(top, "corner",
                  {"name", "angle_deg", "heading_deg", "turn", "direction_in", "direction_out", "feed_in_mm_min",
                   "feed_out_mm_min", "error_max_um", "speed_min_mm_s", "delay_samples", "weight"});
  const auto modes = read_tables(top, "mode", {"frequency_Hz", "residual_max"});
  if (corners.empty() && options.require_corners) {
    top.fail("the task has no corner; at least one [[corner]] with angle_deg and feed_in_mm_min is needed");
  }
  std::vector<CornerLegs> legs;
  Names names;
  for (std::size_t j = 0; j < corners.size(); ++j) {
    legs.push_back(read_legs(corners[j]));
    names.add(corners[j], name_of(corners[j], j));
  }
  task.machine.axes = read_axes(axes, legs, corners, options);
  for (const Table& mode : modes) task.machine.modes.push_back(read_mode(mode));
  for (std::size_t j = 0; j < corners.size(); ++j) {
    task.corners.push_back(read_corner(corners[j], name_of(corners[j], j), legs[j], task.machine.axes.size()));
    check_feeds(task.corners.back(), corners[j], task.machine);
  }
  if (options.require_choices) require_choices(task, top, corners);
  return task;
}

Task parse_task(std::string_view text, const std::string& name, const TaskOptions& options) {
  if (text.find_first_not_of(" \t\r\n") == std::string_view::npos) {
    throw InputError(name, 1, 1, "the file is empty; a task needs at least sample_period_ms and one [[corner]]");
  }
  toml::table tree;
  try {
    tree = toml::parse(text, name);
  } catch (const toml::parse_error& error) {
    throw InputError(name, error.source().begin.line, error.source().begin.column,
                     fmt::format("not valid TOML: {}", error.description()));
  }
  return task_from_tree(tree, name, "", options);
}

Task read_task(const std::string& path, const TaskOptions& options) {
  return parse_task(read_text_file(path), path, options);
}

}  // namespace accdec
