#pragma once

#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

namespace accdec {

/// Libraries this was built with and their versions, in alphabetical order; of solvers those that run.
std::vector<std::pair<std::string, std::string>> libraries();

/// The commit of the sources, with ", changed" where they differ from it; "unknown" outside of a checkout.
std::string source_commit();

/// Adds what a result was made with to a manifest: `accdec` (version), `commit` (with ", changed" where sources differ
/// from it), `libraries`, `linear_algebra` (files), `compiler`, `machine` {processor, cores, memory_GiB, system} and
/// `finished` (UTC).
void add_environment(nlohmann::ordered_json& manifest, const std::string& version);

}  // namespace accdec
