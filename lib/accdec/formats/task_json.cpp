#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <accdec/files/json_position.hpp>
#include <accdec/files/suggestion.hpp>
#include <accdec/files/units.hpp>
#include <accdec/formats/rotary_table.hpp>
#include <accdec/formats/si_names.hpp>
#include <accdec/formats/task_edit.hpp>
#include <accdec/formats/task_json.hpp>
#include <accdec/formats/task_keys.hpp>
#include <accdec/formats/task_tree.hpp>
#include <accdec/formats/task_writer.hpp>

namespace accdec {
namespace {

using PlainJson = nlohmann::json;

/// A value in SI converted to the unit of its key.
PlainJson in_unit_of(const Key& key, const PlainJson& value) {
  if (key.type != KeyType::number && key.type != KeyType::numbers) return value;
  if (value.is_number()) return from_named_si(key, value.get<double>());
  if (!value.is_array()) return value;
  PlainJson list = PlainJson::array();
  for (const PlainJson& element : value) list.push_back(in_unit_of(key, element));
  return list;
}

/// A number in SI is judged before it is converted, so that the message has the name and unit it was given in.
void require_allowed(const Key& key, const std::string& name, const PlainJson& value, const std::string& file,
                     const std::string& at) {
  if (key.type != KeyType::number && key.type != KeyType::numbers) return;
  if (value.is_array() && key.type == KeyType::numbers) {
    for (const PlainJson& element : value) require_allowed(key, name, element, file, at);
    return;
  }
  if (!value.is_number())
    throw InputError(file, 0, 0, fmt::format("`{}` must be a number, got {}", name, value.dump()), at);
  const double given = value.get<double>();
  if (key.range.holds(from_named_si(key, given))) return;
  throw InputError(file, 0, 0, fmt::format("`{}` = {} is out of range; {}", name, given, range_in_si(key).text(name)),
                   at);
}

/// A misspelt name without a unit is meant as a name in SI, so the suggestion is one, too.
/// @param label  how messages call the table  @param axis  its name in a table of an axis
void require_known(std::string_view name, std::string_view which, const std::string& label, const std::string& file,
                   std::string_view axis) {
  const std::vector<Key>& keys = which.empty() ? task_file().keys : find_key(task_file().keys, which)->keys;
  const bool turns = is_rotary(axis);
  if (find_key(keys, name) != nullptr || (unit_in_name(name) != nullptr && !turns)) return;
  if (const std::string wrong = which == "axis" ? of_other_axes(name, axis) : ""; !wrong.empty())
    throw InputError(file, 0, 0, wrong);
  std::vector<std::string> names;
  for (const Key& key : keys) {
    if (turns ? rotary_key(key.name) != key.name : which == "axis" && is_rotary_key(key.name)) continue;
    const std::string short_name = si_name(key);
    names.push_back(key_in_si(which, short_name, turns) == &key ? short_name : key.name);
  }
  const std::string hint = suggest(name, std::vector<std::string_view>(names.begin(), names.end()));
  throw InputError(file, 0, 0, fmt::format("unknown key `{}` in {}; {}", name, label, hint));
}

/// Renames and converts the SI keys of a table.
/// @param at  its JSON pointer  @param axis  name of an axis whose table has none
void to_file_keys(PlainJson& table, std::string_view which, const std::string& label, const std::string& file,
                  const std::string& at, std::string_view axis = "") {
  if (!table.is_object()) return;
  PlainJson renamed = PlainJson::object();
  const auto named = table.find("name");
  const std::string axis_name = which != "axis"                              ? ""
                                : named != table.end() && named->is_string() ? named->get<std::string>()
                                                                             : std::string(axis);
  for (const auto& [name, value] : table.items()) {
    const Key* key = key_in_si(which, name, is_rotary(axis_name));
    if (!key) require_known(name, which, label, file, axis_name);
    if (key && table.contains(key->name))
      throw InputError(file, 0, 0, fmt::format("`{}` and `{}` are both given; allowed is either", name, key->name), at);
    if (key) require_allowed(*key, name, value, file, at + "/" + key->name);
    renamed[key ? key->name : name] = key ? in_unit_of(*key, value) : value;
  }
  table = std::move(renamed);
}

void to_file_keys(PlainJson& task, const std::string& file) {
  to_file_keys(task, "", "the task (top level)", file, "");
  for (const char* const table : {"design", "machine", "axis", "corner", "mode", "program", "controller"}) {
    const auto found = task.find(table);
    if (found == task.end()) continue;
    if (found->is_array()) {
      for (std::size_t i = 0; i < found->size(); ++i)
        to_file_keys((*found)[i], table, fmt::format("[[{}]] {}", table, i + 1), file, fmt::format("/{}/{}", table, i),
                     found->size() > 1 && i < task_keys::axes_limit ? task_keys::axis_names[i] : "");
    } else {
      to_file_keys(*found, table, fmt::format("[{}]", table), file, fmt::format("/{}", table));
    }
  }
}

toml::table to_table(const PlainJson& object, const std::string& file, int depth);

/// Adds a value to a list, as the reader's own type.
void put(toml::array& list, const PlainJson& value, const std::string& key, const std::string& file, int depth) {
  if (depth > 4) throw InputError(file, 0, 0, fmt::format("`{}` is nested too deeply for a task", key));
  if (value.is_object()) {
    list.push_back(to_table(value, file, depth + 1));
  } else if (value.is_array()) {
    toml::array inner;
    for (const PlainJson& element : value) put(inner, element, key, file, depth + 1);
    list.push_back(std::move(inner));
  } else if (value.is_string()) {
    list.push_back(value.get<std::string>());
  } else if (value.is_boolean()) {
    list.push_back(value.get<bool>());
  } else if (value.is_number_integer() && std::abs(value.get<double>()) < 9e18) {
    list.push_back(value.get<std::int64_t>());
  } else if (value.is_number()) {
    list.push_back(value.get<double>());
  } else {
    throw InputError(file, 0, 0, fmt::format("`{}` must not be null; leave the key out", key));
  }
}

toml::table to_table(const PlainJson& object, const std::string& file, int depth) {
  toml::table table;
  for (const auto& [key, value] : object.items()) {
    toml::array one;
    put(one, value, key, file, depth);
    table.insert_or_assign(key, one[0]);
  }
  return table;
}

using Setting = std::pair<std::string, double>;

/// {"corner.A.error_max_um", 50} for "corner.A.error_max", 5e-5; unchanged if the key is not an SI key.
/// @param axis  the name of an axis whose key it is
Setting in_file_unit(const std::string& key, double value, std::string_view axis = "") {
  const std::size_t dot = key.rfind('.');
  const std::string table = key.substr(0, std::min(key.find('.'), key.size()));
  const std::string last = dot == std::string::npos ? key : key.substr(dot + 1);
  const Key* found = key_in_si(dot == std::string::npos ? "" : table, last, is_rotary(axis));
  if (!found) return {key, value};
  return {key.substr(0, key.size() - last.size()) + found->name, in_unit_of(*found, value).get<double>()};
}

/// The same for each axis that the key is about: the keys of rotary axes are others.
std::vector<Setting> in_file_units(const PlainJson& task, const std::string& key, double value) {
  const std::size_t dot = key.find('.'), last = key.rfind('.');
  std::vector<Setting> settings;
  if (key.substr(0, dot) == "axis" && last > dot && task.contains("axis")) {
    const std::string which = key.substr(dot + 1, last - dot - 1), name = key.substr(last + 1);
    for (std::size_t i = 0; i < task["axis"].size(); ++i) {
      const std::string axis = task["axis"][i].value("name", "");
      if (which != "*" && which != axis && which != std::to_string(i)) continue;
      if (const std::string wrong = of_other_axes(name, axis); !wrong.empty()) throw InputError(key, 0, 0, wrong);
      settings.push_back(in_file_unit(fmt::format("axis.{}.{}", i, name), value, axis));
    }
  }
  if (settings.empty()) settings.push_back(in_file_unit(key, value));
  return settings;
}

}  // namespace

Task parse_task_json(std::string_view text, const std::string& name, const TaskOptions& options) {
  if (const auto at = json_too_deep(text)) {
    const auto [line, column] = line_and_column(text, *at);
    throw InputError(name, line, column, "brackets nest more than 64 deep; no task does");
  }
  PlainJson json;
  try {
    json = PlainJson::parse(text);
  } catch (const PlainJson::exception& error) {
    throw InputError(name, 0, 0, fmt::format("not valid JSON: {}", error.what()));
  }
  if (const auto at = duplicate_key(text)) {
    const auto [line, column] = line_and_column(text, *at);
    throw InputError(name, line, column, "this key stands twice in its object; each may stand once");
  }
  if (!json.is_object()) throw InputError(name, 0, 0, "a task is an object with sample_period and corner");
  to_file_keys(json, name);
  return task_from_tree(to_table(json, name, 0), name, "", options);
}

Task with_setting(const Task& task, const std::string& key, double value) {
  const PlainJson json = PlainJson::parse(task_to_json(task).dump());
  toml::table tree = to_table(json, key, 0);
  for (const auto& [file_key, number] : in_file_units(json, key, value)) TaskKey(file_key).set(tree, number);
  return task_from_tree(tree, key, "", {.require_corners = !task.corners.empty(), .response = Considered::all});
}

}  // namespace accdec
