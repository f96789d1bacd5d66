#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace accdec {

/// Adds what a result was made with to a manifest: `accdec` (version), `commit` (with ", changed" where sources differ
/// from it), `libraries`, `linear_algebra` (files), `compiler`, `machine` {processor, cores, memory_GiB, system} and
/// `finished` (UTC).
void add_environment(nlohmann::ordered_json& manifest, const std::string& version);

}  // namespace accdec
