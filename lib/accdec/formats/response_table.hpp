#pragma once

#include <string_view>
#include <vector>

#include <accdec/files/file_kind.hpp>
#include <accdec/files/toml_table.hpp>
#include <accdec/task.hpp>

// Internal to the room: the keys of task files about what follows the filter (machine/response.hpp).

namespace accdec {

/// Keys of an [[axis]].
std::vector<Key> servo_keys();
/// Taps of a response, none if not given. @throws InputError unless their sum is 1
std::vector<double> read_response(const toml_input::Table& table, std::string_view key);
/// Reads `prefilter_taps` and `position_unit_um` of [controller].
void read_control(const toml_input::Table& table, Machine& machine);
/// The servo of an [[axis]]. @throws InputError at keys that exclude each other
void read_servo(const toml_input::Table& table, Axis& axis);
/// @param top  of the task  @param task  as read from it
/// @throws InputError at a response that is not considered, or does not end
void check_response(const toml_input::Table& top, const Task& task, Considered considered);

}  // namespace accdec
