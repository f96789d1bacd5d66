#include <cmath>

#include <nlohmann/json.hpp>

#include <accdec/formats/explanation.hpp>
#include <accdec/formats/task_writer.hpp>
#include <accdec/machine/limit_unit.hpp>

namespace accdec {
namespace {

using Json = nlohmann::ordered_json;

Json finite(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

/// In the unit of the lever's task key; residual vibration is a fraction there.
double in_key(const Lever& lever, double si) {
  return lever.kind == LimitKind::vibration ? si : lever.per_si * si;
}

template <class Value>
Json levers_json(const Room& room, const char* name, Value value) {
  Json levers = Json::array();
  for (std::size_t i = 0; i < room.levers.size(); ++i) {
    const Lever& lever = room.levers[i];
    Json one{{"name", lever.name}, {"key", lever.key}, {"value", finite(in_key(lever, lever.value))}};
    if (const std::optional<double> other = value(i)) one[name] = finite(in_key(lever, *other));
    levers.push_back(std::move(one));
  }
  return levers;
}

Json binding_json(const Binding& b) {
  Json json{{"kind", to_string(b.kind)},   {"axis", b.axis},       {"corner", b.corner},
            {"event", to_string(b.event)}, {"samples", b.samples}, {"bound", si_over_inside(b.kind, b.axis) * b.bound}};
  if (of_mode(b.kind)) json["frequency_Hz"] = b.frequency;
  if (b.damping > 0.0) json["damping_ratio"] = b.damping;
  return json;
}

Json gain_json(const Gain& g, double share) {
  return {{"name", g.room.name},
          {"key", g.room.key},
          {"levers", levers_json(g.room, "relaxed",
                                 [&](std::size_t i) { return std::optional<double>(g.room.levers[i].moved(share)); })},
          {"gain_s", g.gain},
          {"gain_at_most_s", finite(g.at_most)},
          {"objective_s", g.objective},
          {"order", g.order},
          {"delays_samples", g.delays},
          {"proved", g.proved()},
          {"solved", g.solved}};
}

Json remedy_json(const Remedy& r) {
  const bool yes = r.help == Remedy::Help::yes;
  Json json{{"name", r.room.name},
            {"key", r.room.key},
            {"helps", yes                          ? "yes"
                      : r.help == Remedy::Help::no ? "no"
                                                   : "unknown"},
            {"levers", levers_json(r.room, "enough", [&](std::size_t i) {
               return yes ? std::optional<double>(r.values[i]) : std::nullopt;
             })}};
  if (!yes) return json;
  json["share"] = r.share;
  json["smallest"] = r.smallest;
  json["objective_s"] = r.objective;
  return json;
}

}  // namespace

std::string explanation_to_json(const Explanation& e) {
  Json json{{"schema", "accdec.explanation/1"},
            {"task", task_to_json(e.base.task)},
            {"status", to_string(e.base.status)},
            {"message", e.base.message},
            {"proved", e.base_proved}};
  if (e.base.filter) {
    json["objective_s"] = e.base.objective();
    json["lower_bound_s"] = e.base.lower_bound ? Json(*e.base.lower_bound) : Json(nullptr);
    json["order"] = e.base.filter->order();
    json["bindings"] = Json::array();
    for (const Binding& b : e.bindings) json["bindings"].push_back(binding_json(b));
    json["share"] = e.share;
    json["gains"] = Json::array();
    for (const Gain& g : e.gains) json["gains"].push_back(gain_json(g, e.share));
    json["not_moved"] = Json::array();
    for (const Lever& lever : e.not_moved) json["not_moved"].push_back(lever.key);
  } else {
    json["remedy_tolerance"] = remedy_tolerance;
    json["remedies"] = Json::array();
    for (const Remedy& r : e.remedies) json["remedies"].push_back(remedy_json(r));
  }
  json["solves"] = e.solves;
  if (e.shared > 0.0) json["designs_shared_s"] = e.shared;
  json["complete"] = e.complete;
  return json.dump(2) + "\n";
}

}  // namespace accdec
