#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace accdec {

/// Adds what a result was made with to a manifest: `accdec` (version), `libraries`, `compiler`, `machine` {processor, cores, memory_GiB,
/// system} and `finished` (UTC).
void add_environment(nlohmann::ordered_json& manifest, const std::string& version);

}  // namespace accdec
