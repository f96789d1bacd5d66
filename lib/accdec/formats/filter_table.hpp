#pragma once

#include <nlohmann/json.hpp>

#include <accdec/files/toml_table.hpp>
#include <accdec/filter.hpp>

namespace accdec {

// Internal to this folder: reads and writes a filter in a file, [filter] or [baseline]. `shape_list` describes each
// kind.

/// @param table  checked, with the keys `filter_keys`
/// @throws InputError at the key that is wrong
FilterSpec read_filter(const toml_input::Table& table);

nlohmann::ordered_json filter_to_json(const FilterSpec& spec);

}  // namespace accdec
