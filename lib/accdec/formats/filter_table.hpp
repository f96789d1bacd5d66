#pragma once

#include <nlohmann/json.hpp>

#include <accdec/files/toml_table.hpp>
#include <accdec/motion/filter_spec.hpp>

namespace accdec {

// Internal to the room: a filter in a file, [filter] or [baseline], read and written by what `shape_list` says of each
// kind.

/// @param table  checked, with the keys `filter_keys`
/// @throws InputError at the key that is wrong
FilterSpec read_filter(const toml_input::Table& table);

nlohmann::ordered_json filter_to_json(const FilterSpec& spec);

}  // namespace accdec
