#include <cmath>

#include <nlohmann/json.hpp>

#include <accdec/formats/export/exported_json.hpp>
#include <accdec/task/settings_text.hpp>

namespace accdec {
namespace {

using Json = nlohmann::ordered_json;

Json limit_json(const ExportedLimit& limit) {
  Json json{{"kind", limit.kind}};
  if (!limit.axis.empty()) json["axis"] = limit.axis;
  if (!limit.corner.empty()) json["corner"] = limit.corner;
  if (!limit.frequency.empty()) json["frequency_Hz"] = limit.frequency;
  if (!limit.damping.empty()) json["damping_ratio"] = limit.damping;
  json["bound"] = limit.bound;
  json["unit"] = limit.unit;
  if (limit.used && std::isfinite(*limit.used)) json["used"] = *limit.used;
  return json;
}

}  // namespace

void add_about(Json& json, const ExportedDesign& design) {
  json["corners"] = Json::array();
  const std::vector<DelayKind> kinds = chosen_delay_kinds(design.result);
  for (const CornerResult& corner : design.result.corners) {
    const std::size_t j = json["corners"].size();
    json["corners"].push_back({{"name", corner.name}, {"delay_samples", corner.delay}});
    if (!kinds.empty()) json["corners"].back()["delay_by"] = to_string(kinds[j]);
    if (corner.feed_part < 1.0) json["corners"].back()["feed_part"] = corner.feed_part;
  }
  if (design.result.settings) {
    const ChosenSettings& chosen = *design.result.settings;
    json["family"] = to_string(chosen.family);
    json["settings"] = Json::array();
    for (const Setting& setting : chosen.values)
      json["settings"].push_back({{"name", setting.name}, {"value", setting.value}, {"unit", setting.unit}});
    if (chosen.width) json["in_position_width_m"] = chosen.width->middle();
  }
  json["title"] = design.result.task.title;
  json["status"] = to_string(design.result.status);
  json["limits"] = Json::array();
  for (const ExportedLimit& limit : design.limits) json["limits"].push_back(limit_json(limit));
  json["commit"] = design.commit;
}

std::string exported_text(const Json& json, int indent) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

std::string json_export(const ExportedDesign& design) {
  Json json;
  json["order"] = design.filter.order();
  json["sample_period_s"] = design.period;
  json["taps"] = std::vector<double>(design.filter.taps().begin(), design.filter.taps().end());
  if (const auto& q = design.result.quantisation) {
    json["coefficient_bits"] = q->bits;
    json["coefficients"] = q->coefficients;
  }
  add_about(json, design);
  return exported_text(json, 2) + "\n";
}

}  // namespace accdec
