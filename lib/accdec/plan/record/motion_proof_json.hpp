#pragma once

#include <nlohmann/json.hpp>

#include <accdec/formats/json_value.hpp>
#include <accdec/program.hpp>

namespace accdec {

/// The multipliers of the bound for any motion, `any_motion_proof` in a result: time_s is what they prove.
inline nlohmann::ordered_json motion_proof_to_json(const CornerBound& bound) {
  nlohmann::ordered_json sections = nlohmann::ordered_json::array();
  for (const MotionProof& proof : bound.proofs) {
    nlohmann::ordered_json legs = nlohmann::ordered_json::array();
    for (const MotionProof::Leg& leg : proof.legs) {
      legs.push_back({{"last_block", leg.last},
                      {"time_s", leg.time},
                      {"shares", leg.shares},
                      {"acceleration", leg.acceleration},
                      {"jerk", leg.jerk},
                      {"way", leg.way}});
    }
    sections.push_back({{"first_block", proof.first}, {"legs", std::move(legs)}});
  }
  return {{"time_s", bound.proved}, {"sections", std::move(sections)}};
}

/// Reads them into a bound.
inline void read_motion_proof(const Value& json, CornerBound& bound) {
  const auto table = [](const Value& rows) {
    std::vector<std::vector<double>> values;
    for (const Value& row : rows.elements()) values.push_back(row.numbers());
    return values;
  };
  json.members({"time_s", "sections"});
  bound.proved = json["time_s"].number();
  for (const Value& section : json["sections"].elements()) {
    section.members({"first_block", "legs"});
    MotionProof& proof = bound.proofs.emplace_back();
    proof.first = section["first_block"].integer<std::size_t>();
    for (const Value& one : section["legs"].elements()) {
      one.members({"last_block", "time_s", "shares", "acceleration", "jerk", "way"});
      MotionProof::Leg& leg = proof.legs.emplace_back();
      leg.last = one["last_block"].integer<std::size_t>();
      leg.time = one["time_s"].number();
      leg.shares = one["shares"].numbers();
      leg.acceleration = table(one["acceleration"]);
      leg.jerk = table(one["jerk"]);
      leg.way = table(one["way"]);
    }
  }
}

}  // namespace accdec
