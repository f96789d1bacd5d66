#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <accdec/files/packed_text.hpp>
#include <accdec/formats/certificate_json.hpp>
#include <accdec/task/objective.hpp>

namespace accdec {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t packed_above = 1'000'000;  // bytes

// What stands in a row before its multiplier.

Json row_json(const proof::TapDifference& r) {
  return {to_string(r.limit), r.sample, r.sign};
}
Json row_json(const proof::EventForce& r) {
  return {r.stop ? "force stop" : "force start", r.axis, r.sample};
}
Json row_json(const proof::Blend& r) {
  return {fmt::format("blend {}", to_string(r.limit)), r.corner, r.axis, r.sample, r.sign};
}
Json row_json(const proof::Error& r) {
  return {"error", r.corner, r.angle};
}
Json row_json(const proof::RangeError& r) {
  return {"range error", r.corner, r.angle, r.in.at, r.in.after, r.in.high, r.out.at, r.out.after, r.out.high};
}
Json row_json(const proof::Budget&) {
  return Json::array({"budget"});
}
Json row_json(const proof::Vibration& r) {
  return {"vibration", r.mode, r.frequency, r.angle};
}
Json row_json(const proof::EventPower& r) {
  return {r.stop ? "regeneration stop" : "power start", r.axis, r.sample, r.low, r.high};
}
Json row_json(const proof::BlendPower& r) {
  return {r.regeneration ? "blend regeneration" : "blend power", r.corner, r.axis, r.sample, r.sign, r.low, r.high};
}
Json row_json(const proof::Speed& r) {
  return {"speed", r.corner, r.sample, r.low, r.high};
}
Json row_json(const proof::Response& r) {
  return {"response", r.sample, r.sign};
}

Json node_json(const proof::TooLong&) {
  return nullptr;
}
Json node_json(const proof::Unreachable&) {
  return "unreachable";
}
Json node_json(const proof::Refuted& n) {
  return n.multipliers;
}
Json node_json(const proof::RefutedSymmetric& n) {
  return {n.multipliers, n.shorter};
}
Json node_json(const proof::SymmetricOrders&) {
  return Json::array({"symmetric"});
}
Json node_json(const proof::Split& n) {
  return {n.corner, n.on_delay ? "d" : "k", n.at};
}
Json node_json(const proof::OrderSplit& n) {
  return Json::array({"N", n.at});
}
Json node_json(const proof::ResponseSplit& n) {
  return {n.sample, "B", n.level};
}
Json node_json(const proof::ByLemma& n) {
  return {"lemma", n.lemma};
}

Json tree_json(const std::vector<proof::Node>& tree) {
  Json json = Json::array();
  for (const proof::Node& node : tree) json.push_back(std::visit([](const auto& n) { return node_json(n); }, node));
  return json;
}

Json lemma_json(const proof::Lemma& lemma) {
  Json json;
  Json& delays = json["delays"] = Json::array();
  for (const proof::CornerDelay& d : lemma.delays) delays.push_back({d.corner, d.delay});
  if (lemma.window)
    json["window"] = {lemma.window->order, lemma.window->anchor, lemma.window->at};
  else
    json["order"] = lemma.order;
  json["tree"] = tree_json(lemma.tree);
  return json;
}

Json proof_json(const proof::ConstantFeed&) {
  return Json::object({{"schema", "accdec.certificate/1"}, {"kind", "constant feed"}});
}
Json proof_json(const proof::CornerSpeed&) {
  return Json::object({{"schema", "accdec.certificate/1"}, {"kind", "corner speed"}});
}
Json proof_json(const proof::Enumeration&) {
  return Json::object({{"kind", "enumeration"}});
}
Json proof_json(const proof::BranchAndBound& proof) {
  Json json;
  json["bound_samples"] = proof.bound_samples ? Json(*proof.bound_samples) : Json(nullptr);
  if (!proof.conflict.empty()) json["conflict"] = proof.conflict;
  json["kind"] = "branch and bound";
  if (!proof.corner_of.empty()) json["corner_of"] = proof.corner_of;
  for (const proof::Lemma& lemma : proof.lemmas) json["lemmas"].push_back(lemma_json(lemma));
  Json& sets = json["multipliers"] = Json::array();
  for (const proof::Multipliers& terms : proof.multipliers) {
    Json& rows = sets.emplace_back(Json::array());
    for (const proof::Term& term : terms) {
      rows.push_back(std::visit([](const auto& row) { return row_json(row); }, term.row));
      rows.back().push_back(term.multiplier);
    }
  }
  json["objective"] = to_string(proof.objective);
  if (proof.objective == Objective::cycle) json["runs"] = proof.runs;
  json["schema"] = "accdec.certificate/1";
  json["tolerance"] = proof.tolerance;
  json["tree"] = tree_json(proof.tree);
  return json;
}

}  // namespace

nlohmann::ordered_json json_of(const Certificate& certificate) {
  return std::visit([](const auto& proof) { return proof_json(proof); }, certificate.proof);
}

nlohmann::ordered_json stored_json_of(const Certificate& certificate) {
  Json plain = json_of(certificate);
  const std::string text = plain.dump();
  if (text.size() <= packed_above) return plain;
  const std::string packed = pack_text(text);
  if (text.size() > most_unpacked(packed.size())) return plain;
  return {{"gzip", packed}, {"kind", "packed"}, {"schema", "accdec.certificate/1"}};
}

std::string certificate_to_json(const Certificate& certificate) {
  return json_of(certificate).dump();
}

}  // namespace accdec
