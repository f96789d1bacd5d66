#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include <accdec/plan/filters/program_settings.hpp>
#include <accdec/plan/record/program_record.hpp>
#include <accdec/plan/record/program_settings_json.hpp>

namespace accdec {
namespace {

using Json = nlohmann::ordered_json;

long count(const Json& json) {
  if (!json.is_number_integer() || json.get<double>() < 0.0)
    throw std::invalid_argument("settings: a count is no whole number: " + json.dump());
  return json.get<long>();
}

std::optional<WidthInterval> width_of(const Json& json) {
  if (!json.contains("width_m")) return std::nullopt;
  const WidthInterval width{json.at("width_low_m").get<double>(),
                            json.at("width_high_m").is_null() ? unlimited : json.at("width_high_m").get<double>()};
  if (!(width.low >= 0.0 && width.low < width.high))
    throw std::invalid_argument("settings.width_low_m must be below settings.width_high_m, and not below 0");
  if (!(std::abs(json.at("width_m").get<double>() - width.middle()) <= 1e-9 * width.middle()))
    throw std::invalid_argument(
        fmt::format("settings.width_m must be the middle of its interval, {:.9g}", width.middle()));
  return width;
}

}  // namespace

Json program_settings_to_json(const ProgramResult& result) {
  const ProgramSettings& settings = *result.settings;
  Json json{{"answer", program_settings_answer(settings, result.cycle_time, result.has_today)},
            {"family", to_string(settings.chosen.family)}};
  json["values"] = Json::array();
  for (const Setting& setting : settings.chosen.values)
    json["values"].push_back({{"name", setting.name}, {"value", setting.value}, {"unit", setting.unit}});
  if (settings.chosen.width) {
    json["width_m"] = settings.chosen.width->middle();
    json["width_low_m"] = settings.chosen.width->low;
    json["width_high_m"] = settings.chosen.width->high < unlimited ? Json(settings.chosen.width->high) : Json(nullptr);
  }
  json["members"] = settings.members;
  json["tried"] = settings.tried;
  json["complete"] = settings.complete;
  if (settings.free_taps) json["free_taps_s"] = *settings.free_taps;
  if (result.has_today) json["today_s"] = settings.today ? Json(*settings.today) : Json(nullptr);
  if (!settings.chosen.delays.empty() && result.plan.path.blocks() <= recorded_blocks_max) {
    json["delays"] = Json::array();
    for (const DelayKind kind : settings.chosen.delays) json["delays"].push_back(to_string(kind));
  }
  return json;
}

void read_program_settings(const Json& json, ProgramResult& result) {
  ProgramSettings& settings = result.settings.emplace();
  const auto family = setting_family_from_string(json.at("family").get<std::string>());
  if (!family) throw std::invalid_argument("settings.family is no family of settings");
  settings.chosen.family = *family;
  for (const Json& value : json.at("values")) {
    settings.chosen.values.push_back(
        {value.at("name").get<std::string>(), value.at("value").get<double>(), value.at("unit").get<std::string>()});
  }
  settings.chosen.width = width_of(json);
  settings.members = count(json.at("members"));
  settings.tried = count(json.at("tried"));
  settings.complete = json.at("complete").get<bool>();
  if (json.contains("free_taps_s")) settings.free_taps = json["free_taps_s"].get<double>();
  result.has_today = json.contains("today_s");
  if (result.has_today && !json["today_s"].is_null()) settings.today = json["today_s"].get<double>();
  for (const Json& word : json.value("delays", Json::array())) {
    const auto kind = delay_kind_from_string(word.get<std::string>());
    if (!kind) throw std::invalid_argument("settings.delays has a word that is no kind of delay: " + word.dump());
    settings.chosen.delays.push_back(*kind);
  }
  if (json.at("answer") != program_settings_answer(settings, result.cycle_time, result.has_today))
    throw std::invalid_argument("settings.answer is not what the other members say");
}

}  // namespace accdec
