#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>
#include <toml++/toml.h>

#include <accdec/files/keys.hpp>
#include <accdec/result.hpp>

// Internal to the room: a controller's settings in result files.

namespace accdec {

/// The keys of `settings` in a result.
std::vector<Key> chosen_settings_keys();

/// @param result  with settings
nlohmann::ordered_json settings_to_json(const DesignResult& result);

/// @param json    checked against the keys
/// @param filter  its member `filter`, as the tree that tasks are read from
/// @throws InputError with the pointer of what is wrong
ChosenSettings settings_from_json(const nlohmann::ordered_json& json, const toml::table& filter,
                                  const std::string& file);

/// @param json  as above
/// @throws InputError if its sentence is not the one that the result gives
void check_answer(const nlohmann::ordered_json& json, const DesignResult& result);

}  // namespace accdec
