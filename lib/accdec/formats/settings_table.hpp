#pragma once

#include <optional>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include <accdec/files/keys.hpp>
#include <accdec/files/toml_table.hpp>
#include <accdec/task.hpp>

// Internal to the room: the keys of task files about what a controller lets its user set.

namespace accdec {

/// The words of a list. @throws InputError at a word that stands there twice
std::vector<std::string> texts_once(const toml_input::Table& table, std::string_view key);

/// Numbers on a grid: more would only take time.
inline constexpr double most_numbers = 1e4;

/// The step of a family's real numbers.
struct GridStep {
  SettingFamily family;
  const char* key;
  double ControllerSettings::*step;
};
inline constexpr GridStep grid_steps[] = {
    {SettingFamily::exponential, "time_constant_step_ms", &ControllerSettings::time_constant_step},
    {SettingFamily::gaussian, "alpha_step", &ControllerSettings::alpha_step},
    {SettingFamily::windowed_sinc, "cutoff_step_Hz", &ControllerSettings::cutoff_step},
    {SettingFamily::shaper, "shaper_frequency_step_Hz", &ControllerSettings::shaper_frequency_step}};

/// @throws InputError if a unit is one of frequencies: a stage's number grows with its time
void require_unit_of_time(const toml_input::Table& table, std::string_view key, const std::string& unit);

/// Whether all families have a length and a real number alone: their only time is the first stage's.
bool all_on_grids(const std::vector<SettingFamily>& families);

/// Those of [design].
std::vector<Key> setting_keys();
/// Those of [controller].
std::vector<Key> controller_keys();

/// The settings that both tables ask for; none if neither names any.
/// @param period  s
/// @param files   whether [controller] may name a file
/// @throws InputError at the key
std::optional<ControllerSettings> read_settings(const std::optional<toml_input::Table>& design,
                                                const std::optional<toml_input::Table>& controller, double period,
                                                bool files);

/// Adds the keys of a task's [design] to its JSON, in the order of the keys, and makes the JSON of [controller], empty
/// without any.
/// @param task  with settings
void write_settings(const Task& task, nlohmann::ordered_json& design, nlohmann::ordered_json& controller);

}  // namespace accdec
