#pragma once

#include <accdec/files/toml_table.hpp>
#include <accdec/machine.hpp>

// Internal: the key force_speed_N of [[axis]].

namespace accdec {

/// The key itself.
Key force_speed_of_files();
/// @throws InputError at the key unless speeds rise, forces fall and the curve is concave
void read_force_speed(const toml_input::Table& table, Axis& axis);

}  // namespace accdec
