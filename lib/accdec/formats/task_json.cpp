#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <accdec/formats/task_edit.hpp>
#include <accdec/formats/task_json.hpp>
#include <accdec/formats/task_keys.hpp>
#include <accdec/formats/task_tree.hpp>
#include <accdec/formats/task_writer.hpp>

namespace accdec {
namespace {

using Json = nlohmann::json;
using task_keys::NumberKey;

/// A key of a file, its name in SI, and its unit; none where SI is the key's own.
struct SiName {
  std::string si, key;
  std::optional<NumberKey> unit;
};

/// "feed_in" of "feed_in_mm_min"; the key itself if it names no unit.
std::string without_unit(std::string_view key) {
  constexpr std::string_view units[] = {"_N_s_m", "_mm_min", "_mm_s3", "_mm_s2", "_mm_s", "_samples", "_deg",
                                        "_um",    "_ms",     "_Hz",    "_kg",    "_N",    "_W"};
  for (const std::string_view unit : units) {
    if (key.ends_with(unit)) return std::string(key.substr(0, key.size() - unit.size()));
  }
  return std::string(key);
}

/// Of every table of a task, "" is the top, the keys that have another name in SI.
const std::map<std::string_view, std::vector<SiName>>& si_names() {
  namespace k = task_keys;
  static const std::map<std::string_view, std::vector<SiName>> all = [] {
    std::map<std::string_view, std::vector<SiName>> names;
    const auto add = [&](std::string_view table, const NumberKey& key) {
      if (std::string si = without_unit(key.key); si != key.key)
        names[table].push_back({std::move(si), std::string(key.key), key});
    };
    add("", k::sample_period);
    for (const NumberKey& key : {k::angle, k::heading, k::feed_in, k::feed_out, k::error_max, k::speed_min})
      add("corner", key);
    names["corner"].push_back({"delay", "delay_samples", std::nullopt});
    names["mode"].push_back({"frequency", "frequency_Hz", std::nullopt});
    add("program", k::error_max);
    for (const auto& key : k::axis_keys) add("axis", key);
    return names;
  }();
  return all;
}

/// Renames and converts what a table gives in SI.
void to_file_keys(Json& table, std::string_view which, const std::string& file) {
  const auto names = si_names().find(which);
  if (!table.is_object() || names == si_names().end()) return;
  for (const SiName& name : names->second) {
    const auto found = table.find(name.si);
    if (found == table.end()) continue;
    if (table.contains(name.key))
      throw InputError(file, 0, 0, fmt::format("`{}` and `{}` are both given; allowed is either", name.si, name.key));
    Json value = *found;
    if (name.unit && value.is_number()) value = task_keys::in_unit(*name.unit, value.get<double>());
    table.erase(found);
    table[name.key] = std::move(value);
  }
}

void to_file_keys(Json& task, const std::string& file) {
  to_file_keys(task, "", file);
  for (const char* const table : {"axis", "corner", "mode", "program"}) {
    const auto found = task.find(table);
    if (found == task.end()) continue;
    if (found->is_array()) {
      for (Json& element : *found) to_file_keys(element, table, file);
    } else {
      to_file_keys(*found, table, file);
    }
  }
}

toml::table to_table(const Json& object, const std::string& file, int depth);

/// Adds a value, as the reader's own kind, to a list.
void put(toml::array& list, const Json& value, const std::string& key, const std::string& file, int depth) {
  if (depth > 4) throw InputError(file, 0, 0, fmt::format("`{}` is nested too deeply for a task", key));
  if (value.is_object()) {
    list.push_back(to_table(value, file, depth + 1));
  } else if (value.is_array()) {
    toml::array inner;
    for (const Json& element : value) put(inner, element, key, file, depth + 1);
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

toml::table to_table(const Json& object, const std::string& file, int depth) {
  toml::table table;
  for (const auto& [key, value] : object.items()) {
    toml::array one;
    put(one, value, key, file, depth);
    table.insert_or_assign(key, one[0]);
  }
  return table;
}

/// "corner.A.error_max_um" of "corner.A.error_max", and the value in its unit; both unchanged where the key is none in
/// SI.
std::pair<std::string, double> in_file_unit(const std::string& key, double value) {
  const std::size_t dot = key.rfind('.');
  const std::string table = key.substr(0, std::min(key.find('.'), key.size()));
  const std::string last = dot == std::string::npos ? key : key.substr(dot + 1);
  const auto names = si_names().find(dot == std::string::npos ? "" : table);
  if (names != si_names().end()) {
    for (const SiName& name : names->second) {
      if (name.si != last) continue;
      return {key.substr(0, key.size() - last.size()) + name.key,
              name.unit ? task_keys::in_unit(*name.unit, value) : value};
    }
  }
  return {key, value};
}

}  // namespace

Task parse_task_json(std::string_view text, const std::string& name, const TaskOptions& options) {
  Json json;
  try {
    json = Json::parse(text);
  } catch (const Json::exception& error) {
    throw InputError(name, 0, 0, fmt::format("not valid JSON: {}", error.what()));
  }
  if (!json.is_object()) throw InputError(name, 0, 0, "a task is an object with sample_period and corner");
  to_file_keys(json, name);
  return task_from_tree(to_table(json, name, 0), name, "", options);
}

Task with_setting(const Task& task, const std::string& key, double value) {
  const auto [file_key, number] = in_file_unit(key, value);
  toml::table tree = to_table(Json::parse(task_to_json(task).dump()), key, 0);
  TaskKey(file_key).set(tree, number);
  return task_from_tree(tree, key, "", {.require_corners = !task.corners.empty()});
}

}  // namespace accdec
