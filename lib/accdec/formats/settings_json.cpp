#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <accdec/formats/filter_table.hpp>
#include <accdec/formats/settings_json.hpp>
#include <accdec/formats/task_keys.hpp>
#include <accdec/machine.hpp>
#include <accdec/task/settings_text.hpp>

namespace accdec {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* filter_place = "/settings/filter";

template <class Names>
Key name_key(std::string name, KeyType type, std::string meaning, const Names& names) {
  Key key{.name = std::move(name), .type = type, .meaning = std::move(meaning), .required = true};
  for (const auto& one : names) key.words.emplace_back(one.name);
  return key;
}

std::string answer_of(const DesignResult& result) {
  std::string line = settings_answer(result);
  if (!line.empty()) line.pop_back();  // its end of line
  return line;
}

}  // namespace

std::vector<Key> chosen_settings_keys() {
  Key filter{.name = "filter",
             .type = KeyType::table,
             .meaning = "the same filter, as [filter] of a task",
             .required = true,
             .free = true};
  Key values{.name = "values", .type = KeyType::tables, .meaning = "the numbers to enter", .required = true};
  values.keys = {{.name = "name",
                  .type = KeyType::text,
                  .meaning = "name of the parameter; empty if it has none",
                  .required = true,
                  .empty_text = true},
                 {.name = "value", .meaning = "value in this unit; 0 is off", .required = true},
                 {.name = "unit",
                  .type = KeyType::text,
                  .meaning = "unit in which it is entered; empty if it has none",
                  .required = true,
                  .empty_text = true}};
  Key delays = name_key("delays", KeyType::words, "kind of delay at each corner, if the task names kinds", delay_kinds);
  delays.required = false;
  const auto width = [](std::string name, std::string meaning, bool nullable) {
    return Key{
        .name = std::move(name), .meaning = std::move(meaning), .unit = "m", .range = {0.0, 1e9}, .nullable = nullable};
  };
  Key answer{.name = "answer",
             .type = KeyType::text,
             .meaning = "what to set in sentences, as `accdec design` prints it first",
             .required = true,
             .empty_text = true};
  return {answer,
          name_key("family", KeyType::word, "one of the task's families", setting_families),
          filter,
          values,
          delays,
          width("width_m", "in-position width to enter, for all corners that are in-position", false),
          width("width_low_m", "smallest width that gives the same delays", false),
          width("width_high_m", "every width below it gives the same delays; null: there is no upper end", true)};
}

nlohmann::ordered_json settings_to_json(const DesignResult& result) {
  const ChosenSettings& settings = *result.settings;
  Json json{{"answer", answer_of(result)},
            {"family", to_string(settings.family)},
            {"filter", filter_to_json(settings.filter)}};
  json["values"] = Json::array();
  for (const Setting& setting : settings.values)
    json["values"].push_back({{"name", setting.name}, {"value", setting.value}, {"unit", setting.unit}});
  for (const DelayKind kind : settings.delays) json["delays"].push_back(to_string(kind));
  if (settings.width) {
    json["width_m"] = settings.width->middle();
    json["width_low_m"] = settings.width->low;
    json["width_high_m"] = settings.width->high < unlimited ? Json(settings.width->high) : Json(nullptr);
  }
  return json;
}

ChosenSettings settings_from_json(const Json& json, const toml::table& filter, const std::string& file) {
  toml_input::check_keys(filter, file, "settings.filter", filter_place, filter_keys()).raise();
  ChosenSettings settings;
  settings.family = *setting_family_from_string(json["family"].get<std::string>());
  settings.filter = read_filter(toml_input::Table(filter, file, "settings.filter", filter_place, filter_keys()));
  for (const Json& value : json["values"]) settings.values.push_back({value["name"], value["value"], value["unit"]});
  if (const auto delays = json.find("delays"); delays != json.end()) {
    for (const Json& kind : *delays) settings.delays.push_back(*delay_kind_from_string(kind.get<std::string>()));
  }
  const bool has_width = json.contains("width_m");
  if (has_width != json.contains("width_low_m") || has_width != json.contains("width_high_m"))
    throw InputError("", 0, 0, "needs width_m, width_low_m and width_high_m together, or none", "/settings");
  if (!has_width) return settings;
  settings.width = {json["width_low_m"],
                    json["width_high_m"].is_null() ? unlimited : json["width_high_m"].get<double>()};
  if (std::abs(json["width_m"].get<double>() - settings.width->middle()) > 1e-9 * settings.width->middle())
    throw InputError("", 0, 0, fmt::format("must be the middle of its interval, {:.9g}", settings.width->middle()),
                     "/settings/width_m");
  return settings;
}

void check_answer(const Json& json, const DesignResult& result) {
  const auto check = [&](const Json& place, const char* pointer) {
    const auto told = place.find("answer");
    if (told != place.end() && *told != answer_of(result))  // older results have none
      throw InputError("", 0, 0, "is not what the other members say", pointer);
  };
  check(json, "/answer");
  if (result.settings) check(json["settings"], "/settings/answer");
}

}  // namespace accdec
