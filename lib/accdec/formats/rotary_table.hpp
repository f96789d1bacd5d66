#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <accdec/files/toml_table.hpp>
#include <accdec/machine.hpp>
#include <accdec/machine/limit_unit.hpp>
#include <accdec/machine/limits.hpp>

// Internal: the keys of rotary axes in [[axis]]. Inside, a degree is a millimetre (files/units.hpp).

namespace accdec {

/// The keys themselves.
std::vector<Key> rotary_keys();

/// The key of a limit of a rotary axis, or of its inertia (`mass_kg`); the key itself where there is none.
std::string_view rotary_key(std::string_view key);

/// Whether it is one of those keys.
bool is_rotary_key(std::string_view key);

/// The values of a rotary axis in SI proper, by the names of their keys without the unit: "velocity_max" in rad/s,
/// "inertia" in kg m^2. Infinite where there is no limit.
std::vector<std::pair<std::string, double>> rotary_in_si(const Axis& axis);

/// @throws InputError at a key of rotary axes in a table that stands for several axes
void refuse_rotary(const toml_input::Table& table);

/// Reads the keys into the limits and the mass of the axis.
/// @param notes  gets a note for a limit that is given in millimetres
/// @throws InputError at a key of an axis that does not turn, or that is given in both units
void read_rotary(const toml_input::Table& table, Axis& axis, std::vector<std::string>& notes);

}  // namespace accdec
