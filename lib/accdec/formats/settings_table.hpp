#pragma once

#include <optional>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include <accdec/files/keys.hpp>
#include <accdec/files/toml_table.hpp>
#include <accdec/task.hpp>

// Internal to the room: the keys of task files about what a controller lets its user set.

namespace accdec {

/// Whether these kinds give any number of samples.
bool any_delay(const std::vector<DelayKind>& kinds);

/// Numbers on a grid: more would only take time.
inline constexpr double most_numbers = 1e4;

/// Those of [design].
std::vector<Key> setting_keys();
/// Those of [controller].
std::vector<Key> controller_keys();

/// The settings that both tables ask for; none if neither names any.
/// @param period  s
/// @throws InputError at the key
std::optional<ControllerSettings> read_settings(const std::optional<toml_input::Table>& design,
                                                const std::optional<toml_input::Table>& controller, double period);

/// Adds the keys of [design] to its JSON, in the order of the keys, and makes the JSON of [controller], empty without
/// any.
void write_settings(const ControllerSettings& settings, nlohmann::ordered_json& design,
                    nlohmann::ordered_json& controller);

}  // namespace accdec
