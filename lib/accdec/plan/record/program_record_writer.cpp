#include <cmath>
#include <vector>

#include <nlohmann/json.hpp>

#include <accdec/plan/filters/program_settings.hpp>
#include <accdec/plan/record/motion_proof_json.hpp>
#include <accdec/plan/record/program_record.hpp>
#include <accdec/plan/record/program_settings_json.hpp>
#include <accdec/plan/record/recorded_joints.hpp>

namespace accdec {
namespace {

using Json = nlohmann::ordered_json;

template <class Value>
Json list(const std::vector<Value>& values) {
  Json json = Json::array();
  for (const Value& value : values) json.push_back(value);
  return json;
}

/// Feed, ramps and largest speed of every leg; speed and filter of every corner, and whether the motion rests there.
Json trajectory_json(const ProfileChain& chain) {
  Json rests = Json::array();
  for (std::size_t c = 0; c <= chain.legs(); ++c) rests.push_back(chain.stops(c) ? 1 : 0);
  return {{"levels", chain.levels}, {"feed_m_s", chain.feed},   {"ramp_m_s2", chain.ramp},
          {"peak_m_s", chain.peak}, {"speed_m_s", chain.speed}, {"stretch_s2_m", chain.stretch},
          {"coast_s", chain.coast}, {"rests", std::move(rests)}};
}

/// Positions of every sample, and how many samples run along every block.
Json free_json(const FreeMotion& free, std::size_t blocks) {
  std::vector<std::size_t> samples(blocks, 0);
  for (const std::uint32_t block : free.block) ++samples[block];
  return {{"samples_of_block", samples}, {"positions_m", free.position}};
}

Json commands_json(const ProgramResult& result) {
  const Toolpath& path = result.plan.path;
  Json json;
  json["axes"] = list(path.axes);
  json["points_m"] = path.points;
  if (!path.programmed.empty()) json["programmed_m"] = path.programmed;
  json["duration_s"] = path.duration;
  // null is no tolerance.
  json["tolerance_m"] = Json::array();
  std::string joints, rapid, arcs;
  for (std::size_t b = 0; b < path.blocks(); ++b) {
    json["tolerance_m"].push_back(path.tolerance[b] < unlimited ? Json(path.tolerance[b]) : Json(nullptr));
    joints += joint_letters[static_cast<std::size_t>(path.joint[b])];
    rapid += path.rapid[b] ? '1' : '0';
    arcs += path.inside_arc[b] ? '1' : '0';
  }
  json["joint"] = joints;
  json["rapid"] = rapid;
  json["inside_arc"] = arcs;
  json["line"] = list(path.line);
  if (const FilteredCommand* command = result.plan.command()) json["delay_samples"] = list(command->delays);
  json["error_m"] = Json::array();
  for (const double error : result.errors)
    json["error_m"].push_back(std::isfinite(error) ? Json(error) : Json(nullptr));
  json["dwell"] = Json::array();
  for (const auto& [block, time] : path.dwell) json["dwell"].push_back({block, time});
  json["dwell_first_s"] = path.dwell_first;
  if (const Trajectory* trajectory = result.plan.trajectory()) {
    json["trajectory"] =
        trajectory->is_free() ? free_json(trajectory->free, path.blocks()) : trajectory_json(trajectory->chain);
  }
  return json;
}

Json inputs_json(const ProgramInputs& inputs) {
  const ToolpathOptions& r = inputs.reading;
  Json json{{"program", inputs.program},
            {"program_hash", inputs.program_hash},
            {"task", inputs.task_path},
            {"task_text", inputs.task_text},
            {"arc_tolerance_m", r.read.arc_tolerance},
            {"clamp_feeds", r.clamp_feeds},
            {"compensate_arcs", r.widen_arcs},
            {"rapid_stops", r.rapid_stops},
            {"dwells_before_filter", r.dwells_before_filter},
            {"interpreted", inputs.interpreted}};
  if (!inputs.tools.table.empty()) json["tool_table"] = inputs.tools.table;
  if (inputs.tools.table_in_inch) json["tool_table_in_inch"] = true;
  if (inputs.tools.length) json["tool_length_m"] = *inputs.tools.length;
  return json;
}

}  // namespace

std::string program_to_json(const ProgramResult& result, const ProgramInputs& inputs) {
  std::string text = program_to_json(result);
  text.erase(text.find_last_of('}'));
  while (!text.empty() && text.back() == '\n') text.pop_back();
  // A line each, not a line a number.
  if (result.settings) text += ",\n  \"settings\": " + program_settings_to_json(result).dump();
  if (!result.settings && result.today) text += ",\n  \"today_s\": " + program_today_json(result).dump();
  if (!result.settings && !result.today_breaks.empty())
    text += ",\n  \"today_breaks\": " + Json(result.today_breaks).dump();
  if (!result.settings && !program_answer(result).empty())
    text += ",\n  \"answer\": " + Json(program_answer(result)).dump(-1, ' ', false, Json::error_handler_t::replace);
  if (result.corner_bound && !result.corner_bound->proofs.empty())
    text += ",\n  \"any_motion_proof\": " + motion_proof_to_json(*result.corner_bound).dump();
  text += ",\n  \"inputs\": " + inputs_json(inputs).dump(-1, ' ', false, Json::error_handler_t::replace);
  const bool all = result.plan.path.blocks() <= recorded_blocks_max;
  return text + ",\n  \"commands\": " + (all ? commands_json(result).dump() : std::string("null")) + "\n}\n";
}

}  // namespace accdec
