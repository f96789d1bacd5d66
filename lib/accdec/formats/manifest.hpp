#pragma once

#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

namespace accdec {

/// Libraries that this was built with and their versions, in alphabetical order.
std::vector<std::pair<std::string, std::string>> libraries();

/// The commit of the sources, with ", changed" if they differ from it; "unknown" outside of a checkout.
std::string source_commit();

/// Adds the environment of a result to a manifest. The members are `accdec` (version), `commit` (with ", changed" if
/// sources differ from it), `libraries`, `linear_algebra` (files) and `compiler`. There are also `machine` {processor,
/// cores, memory_GiB, system} and `finished` (UTC).
void add_environment(nlohmann::ordered_json& manifest, const std::string& version);

}  // namespace accdec
