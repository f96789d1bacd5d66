#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include <accdec/formats/export/exported_design.hpp>

namespace accdec {

/// Delays, title, status, limits and commit as members.
void add_about(nlohmann::ordered_json& json, const ExportedDesign& design);

/// @param indent  -1: on one line
std::string exported_text(const nlohmann::ordered_json& json, int indent);

}  // namespace accdec
