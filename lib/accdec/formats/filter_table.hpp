#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>
#include <toml++/toml.h>

#include <accdec/files/toml_table.hpp>
#include <accdec/motion/filter_spec.hpp>

namespace accdec {

// Internal to the room: a filter in a file, [filter] or [baseline], read and written by what `shape_list` says of each
// kind.

/// Every key such a table may have: kind, order, the shapes' parameters, shaper and shaper_delay.
std::vector<std::string_view> filter_keys();

/// @param name  of the table, "filter" or "baseline"
/// @param elsewhere  see toml_input::Table
/// @throws InputError at the key that is wrong
FilterSpec read_filter(const toml::table& source, const toml_input::Table& top, const std::string& name,
                       std::string (*elsewhere)(std::string_view));

nlohmann::ordered_json filter_to_json(const FilterSpec& spec);

}  // namespace accdec
