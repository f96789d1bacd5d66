#pragma once

#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include <accdec/files/toml_table.hpp>
#include <accdec/machine.hpp>
#include <accdec/task.hpp>

// Internal: the keys of a drive in [[axis]], force_speed_N and force_rms_N, and torque_speed_N_m.

namespace accdec {

/// The key itself, and that of axes that turn.
Key force_speed_of_files();
Key torque_speed_of_files();
/// The curve as it counts, under that key.
nlohmann::ordered_json curve_of_files(std::string_view key, const Axis& axis);
/// @throws InputError at the key unless speeds rise, forces fall and the curve is concave
void read_force_speed(const toml_input::Table& table, Axis& axis);
/// @throws InputError at a limit on force or power that the loads of the axis, which are read, can never reach
void require_load(const toml_input::Table& table, const Axis& axis);
/// An axis that no corner moves may have any dry friction. A task without corners may move every axis.
/// @param axes  the tables; one alone stands for all axes of the task
/// @throws InputError at the dry friction of an axis whose drive could never move it
void check_friction(const std::vector<toml_input::Table>& axes, const Task& task);

}  // namespace accdec
