#pragma once

#include <accdec/files/toml_table.hpp>
#include <accdec/machine.hpp>

// Internal: the table [[mode]] of tasks.

namespace accdec {

/// @throws InputError at the key
Mode read_mode(const toml_input::Table& table);

}  // namespace accdec
