#include <cmath>

#include <fmt/format.h>

#include <accdec/plan/filters/program_settings.hpp>
#include <accdec/plan/filters/settings_for_program.hpp>
#include <accdec/plan/record/program_record.hpp>
#include <accdec/plan/record/program_settings_json.hpp>

namespace accdec {
namespace {

using Json = nlohmann::ordered_json;

std::optional<WidthInterval> width_of(const Value& json) {
  if (!json.has("width_m")) return std::nullopt;
  const WidthInterval width{json["width_low_m"].number(), json["width_high_m"].number_or_infinity()};
  if (!(width.low >= 0.0 && width.low < width.high))
    json["width_low_m"].fail("must be below width_high_m, and not below 0");
  if (!(std::abs(json["width_m"].number() - width.middle()) <= 1e-9 * width.middle()))
    json["width_m"].fail(fmt::format("must be the middle of its interval, {:.9g}", width.middle()));
  return width;
}

/// The impulses behind the averages, whose frequency is the last value. The answer in words counts their samples.
void read_impulses(double sample_period, ChosenSettings& chosen) {
  if (chosen.family != SettingFamily::shaper || chosen.values.empty()) return;
  const Setting& last = chosen.values.back();
  if (last.unit != "Hz" || !(last.value > 0.0)) return;
  for (const ShaperInfo& shaper : shaper_list()) {
    const double delay = shaper.delay_periods / (last.value * sample_period);
    if (last.name != shaper.title || !(delay < 2e6)) continue;
    chosen.filter.pairs = shaper.pairs;
    chosen.filter.outer = shaper.outer;
    const double whole = std::round(delay);
    chosen.filter.pair_delay = std::abs(delay - whole) <= 1e-9 * delay ? whole : delay;
  }
}

}  // namespace

Json program_today_json(const ProgramResult& result) {
  return *result.today < unlimited ? Json(*result.today) : Json(nullptr);
}

void read_program_today(const Value& json, ProgramResult& result) {
  if (json.json().contains("today_s")) result.today = json["today_s"].optional_number().value_or(unlimited);
  if (json.has("today_breaks")) result.today_breaks = json["today_breaks"].text();
}

Json program_settings_to_json(const ProgramResult& result) {
  const ProgramSettings& settings = *result.settings;
  Json json{{"answer", program_settings_answer(result)}, {"family", to_string(settings.chosen.family)}};
  json["values"] = Json::array();
  for (const Setting& setting : settings.chosen.values)
    json["values"].push_back({{"name", setting.name}, {"value", setting.value}, {"unit", setting.unit}});
  if (settings.chosen.width) {
    json["width_m"] = settings.chosen.width->middle();
    json["width_low_m"] = settings.chosen.width->low;
    json["width_high_m"] = settings.chosen.width->high < unlimited ? Json(settings.chosen.width->high) : Json(nullptr);
  }
  if (settings.chosen.family != SettingFamily::taps) {
    json["members"] = settings.members;
    json["tried"] = settings.tried;
    json["guessed"] = settings.guessed;
    json["complete"] = settings.complete;
    if (settings.search_limit) json["search_limit_s"] = *settings.search_limit;
  }
  if (!settings.breaks.empty()) json["breaks"] = settings.breaks;
  if (settings.free_taps) json["free_taps_s"] = *settings.free_taps;
  if (settings.free_taps_limit) json["free_taps_limit_s"] = *settings.free_taps_limit;
  if (result.today) json["today_s"] = program_today_json(result);
  if (!result.today_breaks.empty()) json["today_breaks"] = result.today_breaks;
  if (!settings.chosen.delays.empty() && result.plan.path.blocks() <= recorded_blocks_max) {
    json["delays"] = Json::array();
    for (const DelayKind kind : settings.chosen.delays) json["delays"].push_back(to_string(kind));
  }
  return json;
}

void read_program_settings(const Value& json, const Task& task, ProgramResult& result) {
  ProgramSettings& settings = result.settings.emplace();
  if (task.settings) settings.control = std::make_shared<const ControllerSettings>(*task.settings);
  const auto family = setting_family_from_string(json["family"].text());
  if (!family) json["family"].fail("is no family of settings");
  if (*family == SettingFamily::taps) {
    if (result.plan.command() == nullptr) json["family"].fail("is of plan fixed");
    settings.chosen = taps_to_set(task, result.plan.set());
  } else {
    settings.members = json["members"].integer<long>();
    settings.tried = json["tried"].integer<long>();
    if (json.has("guessed")) settings.guessed = json["guessed"].integer<long>();
    settings.complete = json["complete"].boolean();
    if (json.has("search_limit_s")) settings.search_limit = json["search_limit_s"].number();
  }
  settings.is_today = result.plan.command() != nullptr && is_todays(task, result.plan.set());
  settings.chosen.family = *family;
  settings.today_not_had = todays_filter_not_had(task);
  for (const Value& value : json["values"].elements())
    settings.chosen.values.push_back({value["name"].text(), value["value"].number(), value["unit"].text()});
  read_impulses(result.sample_period, settings.chosen);
  settings.chosen.width = width_of(json);
  if (json.has("breaks")) settings.breaks = json["breaks"].text();
  if (json.has("free_taps_s")) settings.free_taps = json["free_taps_s"].number();
  if (json.has("free_taps_limit_s")) settings.free_taps_limit = json["free_taps_limit_s"].number();
  read_program_today(json, result);
  if (json.has("delays")) {
    for (const Value& word : json["delays"].elements()) {
      const auto kind = delay_kind_from_string(word.text());
      if (!kind) word.fail("is no kind of delay");
      settings.chosen.delays.push_back(*kind);
    }
  }
}

void check_settings_answer(const Value& json, const ProgramResult& result) {
  if (json["answer"].text() != program_settings_answer(result))
    json["answer"].fail("is not what the other members say");
}

}  // namespace accdec
