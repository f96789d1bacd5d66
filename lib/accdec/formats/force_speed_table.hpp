#pragma once

#include <accdec/files/toml_table.hpp>
#include <accdec/machine.hpp>

// Internal: the keys of a drive in [[axis]], force_speed_N and force_rms_N.

namespace accdec {

/// The key itself.
Key force_speed_of_files();
/// @throws InputError at the key unless speeds rise, forces fall and the curve is concave
void read_force_speed(const toml_input::Table& table, Axis& axis);
/// @throws InputError at force_rms_N of an axis without any load
void check_rating(const toml_input::Table& table, const Axis& axis);
/// @throws InputError at the dry friction of an axis whose drive could never move it
void check_friction(const toml_input::Table& table, const Axis& axis);

}  // namespace accdec
