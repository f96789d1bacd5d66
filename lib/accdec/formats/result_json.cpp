#include <cmath>

#include <nlohmann/json.hpp>

#include <accdec/formats/certificate_json.hpp>
#include <accdec/formats/result_json.hpp>
#include <accdec/formats/task_writer.hpp>

namespace accdec {
namespace {

using Json = nlohmann::ordered_json;

Json number(double x) {
  return std::isfinite(x) ? Json(x) : Json(nullptr);
}
Json number(const std::optional<double>& x) {
  return x ? number(*x) : Json(nullptr);
}

Json corner_json(const CornerResult& c) {
  return {{"name", c.name},
          {"delay_samples", c.delay},
          {"corner_error_m", number(c.corner_error)},
          {"polyline_error_m", number(c.polyline_error)},
          {"contour_deviation_m", number(c.contour_deviation)},
          {"speed_min_m_s", number(c.speed_min)},
          {"corner_time_s", number(c.corner_time)}};
}

Json limit_json(const LimitUse& use) {
  Json json{{"kind", to_string(use.kind)},
            {"axis", use.axis},
            {"corner", use.corner},
            {"event", to_string(use.event)},
            {"value", number(use.value)},
            {"bound", number(use.bound)},
            {"utilisation", number(use.utilisation)},
            {"sample", use.sample}};
  if (use.kind == LimitKind::vibration) json["frequency_Hz"] = number(use.frequency);
  return json;
}

}  // namespace

std::string result_to_json(const DesignResult& result) {
  Json json;
  json["schema"] = "accdec.result/1";
  json["status"] = to_string(result.status);
  json["message"] = result.message;
  json["stop"] = to_string(result.stop);
  json["task"] = task_to_json(result.task);
  json["sample_period_s"] = result.task.sample_period;
  json["filter"] = nullptr;
  if (result.filter) {
    const auto taps = result.filter->taps();
    json["filter"] = {{"order", result.filter->order()}, {"taps", std::vector<double>(taps.begin(), taps.end())}};
  }
  json["corners"] = Json::array();
  for (const CornerResult& corner : result.corners) json["corners"].push_back(corner_json(corner));
  json["cycle_time_s"] = number(result.cycle_time);
  json["corner_time_s"] = number(result.corner_time);
  json["lower_bound_s"] = number(result.lower_bound);
  json["gap"] = number(result.gap);
  json["limits"] = Json::array();
  for (const LimitUse& use : result.limits) json["limits"].push_back(limit_json(use));
  const VerificationReport& v = result.verification;
  json["verification"] = {
      {"performed", v.performed},    {"feasible", v.feasible}, {"max_violation", number(v.max_violation)},
      {"tolerance", v.tolerance},    {"worst", v.worst},       {"certificate_checked", v.certificate_checked},
      {"certificate", v.certificate}};
  const SolverReport& s = result.solver;
  json["solver"] = {{"method", s.method},           {"name", s.name},
                    {"version", s.version},         {"claimed", s.claimed},
                    {"evaluations", s.evaluations}, {"wall_time_s", number(s.wall_time)}};
  if (result.certificate) json["certificate"] = json_of(*result.certificate);
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace accdec
