#pragma once

#include <string>
#include <vector>

#include <accdec/files/toml_table.hpp>
#include <accdec/task.hpp>

// Internal: the table [[mode]] of tasks.

namespace accdec {

std::vector<Key> mode_keys();
/// Conditions on several of them, as of Key::conditions.
std::string mode_conditions();
/// @throws InputError at the key
Mode read_mode(const toml_input::Table& table);
/// Finds the axis that it names. @param task  with its axes and settings  @throws InputError at the key
void find_axis_of_mode(const toml_input::Table& table, const Task& task, Mode& mode);

}  // namespace accdec
