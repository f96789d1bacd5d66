#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include <accdec/files/file_kind.hpp>
#include <accdec/files/parse_toml.hpp>
#include <accdec/files/text_file.hpp>
#include <accdec/files/toml_table.hpp>
#include <accdec/formats/filter_table.hpp>
#include <accdec/formats/force_speed_table.hpp>
#include <accdec/formats/mode_table.hpp>
#include <accdec/formats/response_table.hpp>
#include <accdec/formats/rotary_table.hpp>
#include <accdec/formats/settings_table.hpp>
#include <accdec/formats/task_keys.hpp>
#include <accdec/formats/task_tree.hpp>
#include <accdec/machine/limits.hpp>
#include <accdec/task.hpp>
#include <accdec/task/objective.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

using toml_input::Table;

DesignBounds read_design(const Table& table) {
  DesignBounds bounds;
  bounds.order_min = table.required_integer("order_min");
  bounds.order_max = table.required_integer("order_max");
  bounds.symmetric = table.boolean("symmetric");
  bounds.objective = table.word("objective") == to_string(Objective::cycle) ? Objective::cycle : Objective::corner;
  bounds.runs = table.required_number("runs");
  bounds.coefficient_bits = table.integer("coefficient_bits").value_or(0);
  if (bounds.order_min > bounds.order_max) {
    table.fail_at(
        table.has("order_min") ? "order_min" : "order_max",
        fmt::format("`order_min` = {} is above `order_max` = {}{}; allowed is order_min <= order_max", bounds.order_min,
                    bounds.order_max, table.has("order_max") && table.has("order_min") ? "" : " (the default counts)"));
  }
  return bounds;
}

/// @param name  its name, if the table gives none
Axis read_axis(const Table& table, std::string_view name, std::vector<std::string>& notes) {
  Axis axis;
  axis.name = table.text("name").value_or(std::string(name));
  axis.mass = table.required_number("mass_kg");
  axis.damping = table.required_number("damping_N_s_m");
  for (const AxisLimit& limit : axis_limits)
    if (limit.key != force_speed_key) axis.*limit.bound = table.number(limit.key).value_or(unlimited);
  axis.coulomb = table.required_number("coulomb_N");
  axis.force_rms_max = table.number("force_rms_N").value_or(unlimited);
  read_rotary(table, axis, notes);
  read_force_speed(table, axis);
  require_load(table, axis);
  read_servo(table, axis);
  return axis;
}

/// Reports the first name that is used twice.
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
  for (const std::string_view key : {"direction_in", "direction_out"}) {
    if (!table.has(key))
      table.fail(fmt::format("[[corner]] needs `{}` as well; allowed are both directions, one number an axis", key));
  }
  const std::vector<double> in = table.numbers("direction_in"), out = table.numbers("direction_out");
  if (in.size() != out.size()) {
    table.fail_at(
        "direction_out",
        fmt::format("`direction_out` has {} numbers, `direction_in` {}; both need one an axis", out.size(), in.size()));
  }
  for (const std::string_view key : {"direction_in", "direction_out"}) {
    const auto& direction = key == "direction_in" ? in : out;
    if (std::all_of(direction.begin(), direction.end(), [](double x) { return x == 0.0; })) {
      table.fail_at(key, fmt::format("`{}` is zero in every axis; a leg needs a direction", key));
    }
  }
  return {in, out};
}

CornerLegs read_legs(const Table& table) {
  if (table.has("direction_in") || table.has("direction_out")) return read_directions(table);
  if (!table.has("angle_deg")) table.fail_missing("angle_deg");
  return PlanarLegs{table.required_number("angle_deg"), table.required_number("heading_deg"),
                    table.word("turn") == "left" ? Turn::left : Turn::right};
}

TaskCorner make_task_corner(const Table& table, const std::string& name, const CornerLegs& legs, std::size_t axes) {
  if (std::holds_alternative<PlanarLegs>(legs) && axes < 2)
    table.fail_at("angle_deg", "`angle_deg` needs at least 2 axes; with one axis give direction_in and direction_out");
  const double feed_in = table.required_number("feed_in_mm_min");
  const double feed_out = table.number("feed_out_mm_min").value_or(feed_in);
  try {
    return TaskCorner(name, legs, feed_in, feed_out, static_cast<int>(axes));
  } catch (const std::invalid_argument& error) {
    table.fail(error.what());
  }
}

/// A bound on a distance of the path, m. Between 0 and what rounding does to a simulated path it could only be loosened
/// silently.
std::optional<double> read_distance(const Table& table, const char* key) {
  const std::optional<double> most = table.number(key);
  if (most && *most > 0.0 && *most < position_floor)
    table.fail_at(key, fmt::format("{} = {:g} is less than a simulation can tell from 0; allowed is 0 or {:g} and more",
                                   key, 1e6 * *most, 1e6 * position_floor));
  return most;
}

TaskCorner read_corner(const Table& table, const std::string& name, const CornerLegs& legs, std::size_t axes) {
  TaskCorner corner = make_task_corner(table, name, legs, axes);
  corner.error_max = read_distance(table, "error_max_um");
  corner.contour_max = read_distance(table, "contour_max_um");
  corner.speed_min = table.required_number("speed_min_mm_s");
  corner.delay = table.integer("delay_samples");
  corner.weight = table.required_number("weight");
  return corner;
}

/// Number of components of a leg direction; 0 for legs in the plane.
std::size_t components(const CornerLegs& legs) {
  const auto* directed = std::get_if<DirectedLegs>(&legs);
  return directed ? directed->in.size() : 0;
}

/// Number of axes if there is not one table per axis: as many as the leg directions have components.
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

/// Axes with names. One table stands for all axes, so its name is ignored unless there is only one axis. If it stands
/// for all axes of a program, rotary axes are left out, because their limits are in degrees instead of millimetres. One
/// that names a rotary axis is only that axis.
std::vector<Axis> name_axes(const std::vector<Axis>& given, std::size_t count, bool program) {
  std::vector<Axis> axes(given);
  if (program && given.size() == 1 && is_rotary(given.front().name)) return axes;
  if (given.size() < 2) axes.assign(count, given.empty() ? Axis{} : given.front());
  for (std::size_t i = 0; i < axes.size(); ++i) {
    if (axes[i].name.empty() || (given.size() < 2 && count > 1)) axes[i].name = task_keys::axis_names[i];
  }
  if (program && given.size() == 1) std::erase_if(axes, [](const Axis& axis) { return is_rotary(axis.name); });
  return axes;
}

/// Reports a leg that needs more than an axis's velocity limit.
void check_feeds(const TaskCorner& corner, const Table& table, const Machine& machine) {
  const Corner& legs = corner.geometry();
  for (Eigen::Index a = 0; a < legs.axes(); ++a) {
    const Axis& axis = machine.axes[static_cast<std::size_t>(a)];
    const auto check = [&](std::string_view key, double feed, double part) {
      // The last factor allows for rounding, for example of sqrt(1/2).
      if (feed * std::abs(part) <= axis.velocity_max * (1.0 + 1e-12)) return;
      const char* unit = is_rotary(axis.name) ? "deg" : "mm";
      table.fail_at(table.has(key) ? key : "feed_in_mm_min",
                    fmt::format("corner {}: {} asks axis {} for {:.6g} {}/s; allowed is velocity_max_{}_s = {:.10g} (a "
                                "feed up to {:.10g} mm/min in this direction)",
                                corner.name, key, axis.name, 1e3 * feed * std::abs(part), unit, unit,
                                1e3 * axis.velocity_max, 6e4 * axis.velocity_max / std::abs(part)));
    };
    check("feed_in_mm_min", legs.feed_in, legs.direction_in[a]);
    check("feed_out_mm_min", legs.feed_out, legs.direction_out[a]);
  }
}

/// A check for commands that design nothing. This check is last: errors in the file itself come first.
void require_choices(const Task& task, const Table& top, const std::vector<Table>& corners) {
  if (!task.filter) top.fail("the task has no [filter], which is needed here; `accdec design` chooses one");
  for (std::size_t j = 0; j < corners.size(); ++j) {
    if (task.corners[j].delay) continue;
    corners[j].fail(fmt::format("corner {} has no `delay_samples`, which is needed here; `accdec design` chooses it",
                                task.corners[j].name));
  }
}

/// Reads one task; a class for the state its steps share. It collects errors, so that they are reported together.
class TaskReader {
 public:
  TaskReader(const toml::table& tree, const std::string& file, const std::string& pointer, const TaskOptions& options)
      : faults_(toml_input::check_keys(tree, file, "the task (top level)", pointer, task_file().keys)),
        top_(tree, file, "the task (top level)", pointer, task_file().keys),
        options_(options) {}

  Task read() {
    task_.title = top_.text("title").value_or("");
    task_.sample_period = top_.number("sample_period_ms").value_or(task_.sample_period);
    read_tables();
    read_axes();
    read_legs_of_corners();
    faults_.raise();
    // From here on every table by itself is correct.
    if (corners_.empty() && options_.require_corners)
      top_.fail(
          "the task has no corner; at least one [[corner]] with angle_deg and feed_in_mm_min is needed, unless it is "
          "of a "
          "whole program (`accdec program`; in Python, program=True)");
    place_corners();
    find_axes_of_modes();
    faults_.attempt("/axis", [&] { check_friction(top_.tables("axis"), task_); });
    faults_.raise();
    require_loads();
    check_response(top_, task_, options_.response);
    if (options_.require_choices) require_choices(task_, top_, corners_);
    return std::move(task_);
  }

 private:
  /// Reads [name] unless it already has an error.
  template <class Read>
  void read_table(std::string_view name, Read read) {
    if (const auto table = top_.table(name)) faults_.attempt(table->pointer(), [&] { read(*table); });
  }

  void read_tables() {
    read_table("filter", [&](const Table& table) { task_.filter = read_filter(table); });
    read_table("baseline", [&](const Table& table) { task_.baseline = read_filter(table); });
    read_table("design", [&](const Table& table) { task_.design = read_design(table); });
    faults_.attempt("/design", [&] {
      if (!faults_.none_below("/controller")) return;
      task_.settings =
          read_settings(top_.table("design"), top_.table("controller"), task_.sample_period, options_.controller_files);
    });
    read_table("design", [&](const Table& table) { check_coefficients(table); });
    read_table("controller", [&](const Table& table) { read_control(table, task_.machine); });
    read_table("machine", [&](const Table& table) {
      for (const SupplyLimit& limit : supply_limits)
        task_.machine.*limit.bound = table.number(limit.key).value_or(unlimited);
    });
    read_table("program", [&](const Table& table) {
      task_.program_error_max = read_distance(table, "error_max_um");
      task_.program_contour_max = read_distance(table, "contour_max_um");
    });
    for (const Table& mode : top_.tables("mode"))
      faults_.attempt(mode.pointer(), [&] { task_.machine.modes.push_back(read_mode(mode)); });
  }

  /// The modes that name an axis, once the axes have their names.
  void find_axes_of_modes() {
    const std::vector<Table> tables = top_.tables("mode");
    for (std::size_t i = 0; i < tables.size(); ++i)
      faults_.attempt(tables[i].pointer(), [&] { find_axis_of_mode(tables[i], task_, task_.machine.modes[i]); });
  }

  void check_coefficients(const Table& table) const {
    const auto leave_out = [&, asked = table.has("coefficient_bits")](bool there, const std::string& what) {
      if (asked && there) table.fail_at("coefficient_bits", "`coefficient_bits` designs free taps; leave out " + what);
    };
    leave_out(task_.filter.has_value(), "[filter]");
    leave_out(task_.settings && task_.settings->names_family(), "other families");
    leave_out(task_.settings && task_.settings->names(DelayKind::corner_feed), "the delay `corner-feed`");
  }

  void read_axes() {
    const std::vector<Table> tables = top_.tables("axis");
    if (tables.size() > task_keys::axes_limit) {
      faults_.attempt(tables.back().pointer(), [&] {
        tables.back().fail(
            fmt::format("{} [[axis]] tables; at most {} are allowed", tables.size(), task_keys::axes_limit));
      });
      return;
    }
    Names names;
    for (std::size_t i = 0; i < tables.size(); ++i) {
      faults_.attempt(tables[i].pointer(), [&] {
        const std::string_view name = tables.size() > 1 ? task_keys::axis_names[i] : "";
        task_.machine.axes.push_back(read_axis(tables[i], name, task_.notes));
      });
      if (tables.size() < 2) continue;
      faults_.attempt(tables[i].pointer() + "/name", [&] {
        names.add(tables[i], tables[i].text("name").value_or(std::string(task_keys::axis_names[i])));
      });
    }
  }

  /// A shared supply without any load could never bind.
  void require_loads() const {
    const auto& axes = task_.machine.axes;
    const bool loads = std::any_of(axes.begin(), axes.end(), [](const Axis& axis) {
      return axis.mass > 0.0 || axis.damping > 0.0 || axis.coulomb > 0.0;
    });
    if (loads || !limits_supply(task_.machine)) return;
    const Table table = *top_.table("machine");
    for (const SupplyLimit& limit : supply_limits) {
      if (table.has(limit.key))
        table.fail_at(limit.key,
                      fmt::format("`{}` can never bind: no axis has mass_kg, damping_N_s_m or coulomb_N", limit.key));
    }
  }

  void read_legs_of_corners() {
    corners_ = top_.tables("corner");
    Names names;
    for (std::size_t j = 0; j < corners_.size(); ++j) {
      faults_.attempt(corners_[j].pointer(), [&] { legs_.push_back(read_legs(corners_[j])); });
      faults_.attempt(corners_[j].pointer() + "/name", [&] { names.add(corners_[j], name_of(corners_[j], j)); });
    }
  }

  void place_corners() {
    std::vector<Axis>& axes = task_.machine.axes;
    if (axes.size() < 2) {
      axes = name_axes(axes, count_axes(legs_, corners_, options_), corners_.empty() && options_.axes > 1);
      if (const auto tables = top_.tables("axis"); axes.size() > 1 && !tables.empty()) refuse_rotary(tables.front());
    } else {
      axes = name_axes(axes, axes.size(), false);
      for (std::size_t j = 0; j < legs_.size(); ++j) faults_.attempt(corners_[j].pointer(), [&] { check_size(j); });
    }
    for (std::size_t j = 0; j < corners_.size(); ++j) {
      faults_.attempt(corners_[j].pointer(), [&] {
        task_.corners.push_back(read_corner(corners_[j], name_of(corners_[j], j), legs_[j], axes.size()));
        check_feeds(task_.corners.back(), corners_[j], task_.machine);
        if (task_.settings && task_.corners.back().delay && !task_.settings->may_be_given(*task_.corners.back().delay))
          corners_[j].fail_at("delay_samples",
                              "`delay_samples` contradicts [controller] delays: a delay can be given only to a control "
                              "with \"dwell\" or \"timed-axis\"");
      });
    }
  }

  void check_size(std::size_t j) const {
    const std::size_t n = components(legs_[j]), axes = task_.machine.axes.size();
    if (n != 0 && n != axes)
      corners_[j].fail_at("direction_in",
                          fmt::format("`direction_in` has {} numbers for {} axes; one an axis is needed", n, axes));
  }

  Faults faults_;
  Table top_;
  TaskOptions options_;
  std::vector<Table> corners_;
  std::vector<CornerLegs> legs_;
  Task task_;
};

}  // namespace

Task task_from_tree(const toml::table& tree, const std::string& file, const std::string& pointer,
                    const TaskOptions& options) {
  return TaskReader(tree, file, pointer, options).read();
}

Task parse_task(std::string_view text, const std::string& name, const TaskOptions& options) {
  if (text.find_first_not_of(" \t\r\n") == std::string_view::npos) {
    throw InputError(name, 1, 1, "the file is empty; a task needs at least sample_period_ms and one [[corner]]");
  }
  if (const std::string wrong = wrong_kind(text, InputKind::task); !wrong.empty()) throw InputError(name, 1, 1, wrong);
  return task_from_tree(toml_input::parse_toml(text, name), name, "", options);
}

Task read_task(const std::string& path, const TaskOptions& options) {
  return parse_task(read_text_file(path), path, options);
}

}  // namespace accdec
