#include <algorithm>
#include <cmath>
#include <numeric>

#include <nlohmann/json.hpp>

#include <accdec/program/write/program_report.hpp>
#include <accdec/program/write/samples.hpp>

namespace accdec {
namespace {

using Json = nlohmann::ordered_json;

/// null for what JSON cannot say.
Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json limits_json(const ProgramResult& result) {
  Json list = Json::array();
  const Simulation& simulation = result.plan.simulation;
  for (std::size_t i = 0; i < simulation.limits.size(); ++i) {
    const LimitUse& use = simulation.limits[i];
    Json item{{"kind", to_string(use.kind)}, {"axis", use.axis},           {"line", simulation.limit_lines[i]},
              {"value", number(use.value)},  {"bound", number(use.bound)}, {"utilisation", number(use.utilisation)},
              {"sample", use.sample}};
    if (use.kind == LimitKind::vibration) item["frequency_Hz"] = number(use.frequency);
    list.push_back(std::move(item));
  }
  return list;
}

/// By rising order, with the number of blocks that each serves.
Json leg_filters_json(const ProgramResult& result) {
  const auto filters = result.legs.filters();
  std::vector<std::size_t> blocks(filters.size(), 0), order(filters.size());
  for (std::size_t b = 0; b < result.path.blocks(); ++b) ++blocks[result.legs.index(b)];
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return filters[a].order() < filters[b].order(); });
  Json list = Json::array();
  for (const std::size_t i : order) {
    list.push_back({{"order", filters[i].order()},
                    {"blocks", blocks[i]},
                    {"taps", std::vector<double>(filters[i].taps().begin(), filters[i].taps().end())}});
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

}  // namespace

std::string program_to_json(const ProgramResult& result) {
  Json json;
  json["schema"] = "accdec.program/1";
  json["program"] = result.program;
  json["status"] = to_string(result.status);
  json["sample_period_s"] = result.sample_period;
  json["filter"] = {{"order", result.filter.order()},
                    {"taps", std::vector<double>(result.filter.taps().begin(), result.filter.taps().end())}};
  if (!result.legs.single()) json["leg_filters"] = leg_filters_json(result);
  json["plan"] = result.legs.single() ? "fixed" : "per-leg";
  if (!result.candidates.empty()) json["candidates"] = plan_times_to_json(result.candidates);
  json["feeds"] = result.feeds_chosen ? "chosen" : "programmed";
  if (!result.path.programmed.empty()) json["arcs_widened_m"] = widest(result.path);
  json["blocks"] = result.programmed_blocks;
  json["commanded_blocks"] = result.path.blocks();
  json["feeds_clamped"] = result.path.clamped.size();
  json["corners"] = {{"count", result.corners},
                     {"delayed", result.delayed},
                     {"exact_stops", result.exact_stops},
                     {"raised_by_overlap", result.raised},
                     {"slowed_blocks", result.plan.slowed},
                     {"worst_error_m", number(result.worst_error)},
                     {"worst_utilisation", number(result.worst_utilisation)},
                     {"worst_line", result.worst_line}};
  json["worst_corners"] = worst_corners_json(result);
  Json too_fast = Json::array();
  for (const SlowedFeeds& slowed : result.plan.too_fast) {
    too_fast.push_back(
        {{"limit", slowed.limit}, {"blocks", slowed.blocks}, {"factor", slowed.factor}, {"line", slowed.line}});
  }
  json["feeds_slowed"] = std::move(too_fast);
  json["samples"] = result.plan.simulation.samples;
  json["cycle_time_s"] = result.cycle_time;
  if (!result.legs.single()) json["cycle_time_one_filter_s"] = result.cycle_time_one_filter;
  if (result.feeds_chosen && result.cycle_time_kept) json["cycle_time_kept_feeds_s"] = *result.cycle_time_kept;
  json["cycle_time_exact_stop_s"] = result.cycle_time_exact_stop;
  json["exact_stop_breaks"] = result.exact_stop_breaks.empty() ? Json(nullptr) : Json(result.exact_stop_breaks);
  json["cycle_time_no_delay_s"] = result.cycle_time_no_delay;
  json["lower_bound_s"] = result.lower_bound;
  if (result.corner_bound) {
    json["corner_bound_s"] = result.corner_bound->time;
    json["corner_bound"] = corner_bound_to_json(*result.corner_bound);
  }
  if (result.filter_bound) json["filter_bound_s"] = *result.filter_bound;
  if (result.peak_memory > 0) json["peak_memory_bytes"] = result.peak_memory;
  json["delay_total_s"] = result.delay_total;
  json["limits"] = limits_json(result);
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
