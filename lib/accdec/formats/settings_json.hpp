#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>
#include <toml++/toml.h>

#include <accdec/files/keys.hpp>
#include <accdec/task.hpp>

// Internal to the room: a controller's settings in result files.

namespace accdec {

/// The keys of `settings` in a result.
std::vector<Key> chosen_settings_keys();

nlohmann::ordered_json settings_to_json(const ChosenSettings& settings);

/// @param json    checked against the keys
/// @param filter  its member `filter`, as the tree that tasks are read from
/// @throws InputError with the pointer of what is wrong
ChosenSettings settings_from_json(const nlohmann::ordered_json& json, const toml::table& filter,
                                  const std::string& file);

}  // namespace accdec
