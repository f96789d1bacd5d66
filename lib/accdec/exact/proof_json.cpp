#include <cmath>

#include <nlohmann/json.hpp>

#include <accdec/exact/search.hpp>
#include <accdec/task/objective.hpp>

namespace accdec::exact {
namespace {

nlohmann::json row_json(const RowId& id, double y) {
  switch (id.kind) {
    case RowKind::jerk: return {"jerk", id.sample, id.sign, y};
    case RowKind::force_start: return {"force start", id.axis, id.sample, y};
    case RowKind::force_stop: return {"force stop", id.axis, id.sample, y};
    case RowKind::blend_acceleration: return {"blend acceleration", id.corner, id.axis, id.sample, id.sign, y};
    case RowKind::blend_jerk: return {"blend jerk", id.corner, id.axis, id.sample, id.sign, y};
    case RowKind::blend_force: return {"blend force", id.corner, id.axis, id.sample, id.sign, y};
    case RowKind::cone: return {"error", id.corner, id.angle, y};
    case RowKind::range_cone:
      return {"range error", id.corner, id.angle,     id.in.at,    id.in.after,
              id.in.high,    id.out.at, id.out.after, id.out.high, y};
    case RowKind::budget: return {"budget", y};
    case RowKind::vibration: return {"vibration", id.mode, id.frequency, id.angle, y};
    case RowKind::power_start: return {"power start", id.axis, id.sample, id.low, id.high, y};
    case RowKind::regeneration_stop: return {"regeneration stop", id.axis, id.sample, id.low, id.high, y};
    case RowKind::blend_power: return {"blend power", id.corner, id.axis, id.sample, id.sign, id.low, id.high, y};
    case RowKind::blend_regeneration:
      return {"blend regeneration", id.corner, id.axis, id.sample, id.sign, id.low, id.high, y};
    case RowKind::speed: return {"speed", id.corner, id.sample, id.low, id.high, y};
    case RowKind::tube: return {"response", id.sample, id.sign, y};
  }
  return nullptr;
}

}  // namespace

std::string to_json(const Proof& proof, const DesignBounds& design) {
  nlohmann::json out{{"schema", "accdec.certificate/1"}, {"kind", "branch and bound"}};
  out["objective"] = to_string(design.objective);
  if (design.objective == Objective::cycle) out["runs"] = design.runs;
  out["bound_samples"] = std::isfinite(proof.target) ? nlohmann::json(proof.target) : nlohmann::json(nullptr);
  if (!proof.conflict.empty()) out["conflict"] = proof.conflict;
  out["multipliers"] = nlohmann::json::array();
  // Splits that were tried and not taken leave multipliers behind that no leaf uses.
  std::vector<int> number(proof.multipliers.size(), -1);
  const auto used = [&](int index) {
    if (index < 0) return index;
    int& n = number[static_cast<std::size_t>(index)];
    if (n >= 0) return n;
    nlohmann::json rows = nlohmann::json::array();
    for (const auto& [id, value] : proof.multipliers[static_cast<std::size_t>(index)])
      rows.push_back(row_json(id, value));
    out["multipliers"].push_back(std::move(rows));
    n = static_cast<int>(out["multipliers"].size()) - 1;
    return n;
  };
  nlohmann::json tree = nlohmann::json::array();
  for (const Proof::Node& node : proof.tree) {
    if (node.kind == Proof::Node::split)
      tree.push_back({node.corner, node.on_delay ? "d" : "k", node.at});
    else if (node.kind == Proof::Node::order_split)
      tree.push_back({"N", node.at});
    else if (node.kind == Proof::Node::sum_split)
      tree.push_back({node.at, "B", node.level});
    else if (node.kind == Proof::Node::unreachable)
      tree.push_back("unreachable");
    else if (node.kind == Proof::Node::symmetric)
      tree.push_back(nlohmann::json::array({"symmetric"}));
    else if (node.kind == Proof::Node::too_long)
      tree.push_back(nullptr);
    else if (node.shorter == -1)
      tree.push_back(used(node.multipliers));
    else
      tree.push_back({used(node.multipliers), used(node.shorter)});
  }
  out["tree"] = std::move(tree);
  return out.dump();
}

}  // namespace accdec::exact
