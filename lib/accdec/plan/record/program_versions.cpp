#include <algorithm>
#include <utility>

#include <nlohmann/json.hpp>

#include <accdec/machine/limit_unit.hpp>
#include <accdec/plan/record/program_versions.hpp>
#include <accdec/plan/report/plan_facts.hpp>
#include <accdec/plan/trajectory/last_filter.hpp>

namespace accdec {
namespace {

using Json = nlohmann::ordered_json;

/// Joints inside arcs counted as corners are.
Json corners_with_chords(const Json& found, const ProgramResult& result) {
  const Plan& plan = result.plan;
  std::size_t corners = 0, delayed = 0, at_rest = 0;
  for (std::size_t b = 0; b + 1 < plan.path.blocks(); ++b) {
    const int delay = plan.delay(b);
    if (plan.path.joint[b] == Joint::straight && delay == 0) continue;
    ++corners;
    delayed += delay > 0 ? 1 : 0;
    at_rest += rests_after(plan, b) ? 1 : 0;
  }
  Json json{{"count", corners}};
  if (plan.command() != nullptr) {
    json["delayed"] = delayed;
    json["exact_stops"] = at_rest;
    json["raised_by_overlap"] = found.at("raised_by_overlap");
    json["slowed_blocks"] = found.at("slowed_blocks");
  } else {
    json["at_rest"] = at_rest;
  }
  for (const char* name : {"worst_error_m", "worst_utilisation", "worst_line"}) json[name] = found.at(name);
  return json;
}

/// Earlier schemas have a degree as a millimetre.
Json limits_then(Json limits, const ProgramResult& result) {
  for (std::size_t i = 0; i < limits.size(); ++i) {
    const LimitUse& use = result.check.limits[i];
    if (si_over_inside(use.kind, use.axis) != 1.0) limits[i]["value"] = use.value, limits[i]["bound"] = use.bound;
  }
  return limits;
}

Json as_program_1(Json json, const ProgramResult& result, bool per_leg) {
  json["schema"] = "accdec.program/1";
  if (per_leg) json["plan"] = "per-leg";
  json["blocks"] = result.programmed_moves;
  json["corners"] = corners_with_chords(json["corners"], result);
  json["limits"] = limits_then(json["limits"], result);
  for (const char* name : {"straight_moves", "arcs", "repair_rounds", "axis_loads"}) json.erase(name);
  return json;
}

Json as_profiles_1(const Json& found, const ProgramResult& result) {
  Json json;
  json["schema"] = "accdec.profiles/1";
  for (const char* name : {"program", "status", "sample_period_s", "plan", "samples", "cycle_time_s", "lower_bound_s",
                           "repair_rounds", "limits", "message"})
    json[name] = found.at(name);
  json["limits"] = limits_then(json["limits"], result);
  json["blocks"] = result.programmed_moves;
  const int taps = LastFilter(result.plan.filter(), result.sample_period).boxcar();
  json["last_boxcar_taps"] = taps > 0 ? Json(taps) : Json(nullptr);
  json["last_filter"] = found.at("filter");
  json["corners"] = corners_with_chords(found.at("corners"), result);
  json["verification"] = {{"performed", true}, {"feasible", result.verification.feasible}};
  json["wall_time_s"] = found.at("solver").at("wall_time_s");
  return json;
}

}  // namespace

Json as_written_then(Json found, const ProgramResult& result, const ProgramRecord& record) {
  switch (record.schema) {
    case ProgramSchema::program_2: break;
    case ProgramSchema::program_1: return as_program_1(std::move(found), result, record.filters.has_value());
    case ProgramSchema::profiles_1: return as_profiles_1(found, result);
  }
  return found;
}

}  // namespace accdec
