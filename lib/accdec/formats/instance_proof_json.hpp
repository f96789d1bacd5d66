#pragma once

#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include <accdec/certificate/instance_proof.hpp>

namespace accdec {

/// `accdec.refutation/1`: lib/accdec/certificate/README.md has its members.
std::string instance_proof_to_json(const InstanceProof& refutation);
/// The member `at`, which a manifest of instances has as well.
nlohmann::ordered_json place_to_json(const InstanceProof::Place& place, bool of_delay);

/// Whether a text seems to be a refutation: its schema is the first member of what accdec writes.
bool is_instance_proof(std::string_view text);
/// Reads one strictly. The checker decides whether it proves anything (refutation.hpp).
/// @throws InputError with line and column
InstanceProof parse_instance_proof(std::string_view text, const std::string& name);

}  // namespace accdec
