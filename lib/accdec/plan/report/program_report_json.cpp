#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <accdec/machine/limit_unit.hpp>
#include <accdec/plan/report/axis_loads.hpp>
#include <accdec/plan/report/left_at_rest.hpp>
#include <accdec/plan/report/plan_facts.hpp>
#include <accdec/plan/report/samples.hpp>
#include <accdec/program.hpp>
#include <accdec/task/not_considered.hpp>

namespace accdec {
namespace {

using Json = nlohmann::ordered_json;

/// null for what JSON cannot say.
Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json limits_json(const ProgramResult& result) {
  Json list = Json::array();
  const std::size_t turns = smooth_turns(result.plan.path);
  const std::vector<LeftAtRest> left = left_at_rest(result);
  for (std::size_t i = 0; i < left.size(); ++i) {
    const LimitUse& use = result.check.limits[i];
    const double in_si = si_over_inside(use.kind, use.axis);
    Json item{{"kind", to_string(use.kind)},
              {"axis", use.axis},
              {"line", use.line},
              {"value", number(in_si * use.value)},
              {"bound", number(in_si * use.bound)},
              {"utilisation", number(use.utilisation)},
              {"sample", use.sample}};
    if (of_mode(use.kind)) item["frequency_Hz"] = number(use.frequency);
    if (use.damping > 0.0) item["damping_ratio"] = number(use.damping);
    if (use.kind == LimitKind::residual && turns > 0) item["smooth_turns_judged_at_ends"] = turns;
    if (use.kind == LimitKind::residual) item["left_at_end"] = number(in_si * left[i].at_end);
    if (left[i].at_stop > 0.0) item["left_at_stop"] = number(in_si * left[i].at_stop);
    list.push_back(std::move(item));
  }
  return list;
}

Json loads_json(const ProgramResult& result) {
  Json list = Json::array();
  for (const AxisLoad& load : result.loads) {
    Json item{{"axis", load.axis}};
    const auto [unit, per_si] = limit_unit(LimitKind::force, load.axis);
    const auto put = [&, per_si = per_si, suffix = find_unit(unit)->suffix](const char* what, double value) {
      item[fmt::format("{}_{}{}", limit_word(LimitKind::force, load.axis), what, suffix)] = number(per_si * value);
    };
    put("peak", load.peak), put("rms", load.rms);
    if (load.rms_max < unlimited) put("rms_max", load.rms_max);
    list.push_back(std::move(item));
  }
  return list;
}

Json estimates_json(const ProgramResult& result) {
  Json list = Json::array();
  for (const ControlEstimate& estimate : result.estimates) {
    Json parameters = Json::array();
    for (const ControlParameter& one : estimate.parameters)
      parameters.push_back({{"name", one.name}, {"unit", one.unit}, {"value", one.value}, {"from", one.from}});
    list.push_back({{"control", estimate.control},
                    {"time_s", number(estimate.time)},
                    {"parameters", std::move(parameters)},
                    {"not_known", estimate.unknown}});
  }
  return list;
}

Json worst_corners_json(const ProgramResult& result) {
  Json list = Json::array();
  for (const CornerUse& corner : worst_corners(result, result.worst_shown)) {
    list.push_back({{"line", corner.line},
                    {"corner_error_m", number(corner.error)},
                    {"error_max_m", number(corner.tolerance)},
                    {"utilisation", number(corner.utilisation)},
                    {"delay_samples", corner.delay}});
  }
  return list;
}

Json overrides_json(const ProgramResult& result) {
  Json list = Json::array();
  for (const FeedOverride& at : result.overrides) {
    list.push_back({{"percent", std::lround(100.0 * at.factor)},
                    {"worst_error_m", number(at.worst_error)},
                    {"worst_utilisation", number(at.worst_utilisation)},
                    {"worst_line", at.worst_line},
                    {"limit_utilisation", number(at.limit_utilisation)},
                    {"limit", at.limit}});
  }
  return list;
}

void add_times(Json& json, const ProgramResult& result) {
  const auto add = [&](const char* name, const std::optional<double>& time) {
    if (time) json[name] = *time;
  };
  json["cycle_time_s"] = result.cycle_time;
  if (result.feeds_chosen) add("cycle_time_kept_feeds_s", result.cycle_time_kept);
  add("cycle_time_exact_stop_s", result.cycle_time_exact_stop);
  if (result.cycle_time_exact_stop)
    json["exact_stop_breaks"] = result.exact_stop_breaks.empty() ? Json(nullptr) : Json(result.exact_stop_breaks);
  add("cycle_time_no_delay_s", result.cycle_time_no_delay);
  json["lower_bound_s"] = result.lower_bound;
  json["bounds"] = bounds_to_json(named_bounds(result.lower_bound, result.corner_bound));
  if (result.corner_bound) {
    json["corner_bound_s"] = result.corner_bound->time;
    json["corner_bound"] = corner_bound_to_json(*result.corner_bound);
  }
  add("filter_bound_s", result.filter_bound);
  if (result.peak_memory > 0) json["peak_memory_bytes"] = result.peak_memory;
  json["control_must"] = control_needs(result);
  json["not_considered"] = Json::array();
  for (const NotConsidered what : not_considered(moved_machine(result)))
    json["not_considered"].push_back(to_string(what));
  if (result.servo)
    json["servo"] = {{"settling_s", result.servo->settling},
                     {"within_m", result.servo->within},
                     {"stop_error_m", number(result.servo->stop_error)}};
  if (result.servo && result.plan.command()->moved.size() > 1) json["servo"]["axes_differ"] = true;
  if (result.servo && result.servo->legs) {
    json["servo"]["leg_error_m"] = result.servo->legs->error;
    json["servo"]["leg_line"] = result.servo->legs->line;
  }
  if (!result.overrides.empty()) json["feed_overrides"] = overrides_json(result);
  json["delay_total_s"] = result.delay_total;
}

}  // namespace

std::string program_to_json(const ProgramResult& result) {
  const Filter& filter = result.plan.set();
  Json json;
  json["schema"] = "accdec.program/2";
  json["program"] = result.program;
  json["status"] = to_string(result.status);
  json["sample_period_s"] = result.sample_period;
  json["plan"] = result.plan.name();
  json["filter"] = {{"order", filter.order()},
                    {"taps", std::vector<double>(filter.taps().begin(), filter.taps().end())}};
  if (!result.candidates.empty()) json["candidates"] = plan_times_to_json(result.candidates);
  json["feeds"] = result.feeds_chosen ? "chosen" : "programmed";
  if (!result.plan.path.programmed.empty()) json["arcs_widened_m"] = largest_widening(result.plan.path);
  if (!result.compensation.empty()) json["compensation"] = result.compensation;
  json["blocks"] = result.programmed_blocks;
  json["straight_moves"] = result.programmed_moves;
  json["commanded_blocks"] = result.plan.path.blocks();
  json["feeds_clamped"] = result.plan.path.clamped.size();
  json["corners"] = {{"count", result.corners},
                     {"delayed", result.delayed},
                     {"at_rest", result.at_rest},
                     {"raised_by_overlap", result.raised},
                     {"slowed_blocks", result.slowed},
                     {"worst_error_m", number(result.worst_error)},
                     {"worst_utilisation", number(result.worst_utilisation)},
                     {"worst_line", result.worst_line}};
  if (result.arcs)
    json["arcs"] = {{"worst_error_m", number(result.arcs->error)},
                    {"error_max_m", number(result.arcs->tolerance)},
                    {"worst_line", result.arcs->line}};
  json["worst_corners"] = worst_corners_json(result);
  json["feeds_slowed"] = Json::array();
  for (const SlowedFeeds& slowed : result.too_fast) {
    json["feeds_slowed"].push_back(
        {{"limit", slowed.limit}, {"blocks", slowed.blocks}, {"factor", slowed.factor}, {"line", slowed.line}});
  }
  json["repair_rounds"] = result.rounds;
  json["samples"] = result.check.samples;
  add_times(json, result);
  if (!result.estimates.empty()) json["estimates"] = estimates_json(result);
  json["limits"] = limits_json(result);
  if (!result.loads.empty()) json["axis_loads"] = loads_json(result);
  json["verification"] = {{"performed", result.verification.performed},
                          {"feasible", result.verification.feasible},
                          {"max_violation", number(result.verification.max_violation)},
                          {"tolerance", result.verification.tolerance},
                          {"worst", result.verification.worst}};
  json["solver"] = {{"method", result.solver.method},           {"name", result.solver.name},
                    {"version", result.solver.version},         {"claimed", result.solver.claimed},
                    {"evaluations", result.solver.evaluations}, {"wall_time_s", result.solver.wall_time}};
  json["message"] = result.message;
  return json.dump(2) + "\n";
}

}  // namespace accdec
