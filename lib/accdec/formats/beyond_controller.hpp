#pragma once

#include <optional>

#include <accdec/files/toml_table.hpp>
#include <accdec/task.hpp>

namespace accdec {

/// Refuses keys of a task that give its named controller more than it has: another family, longer times, finer steps,
/// times out of its set, other kinds of delays. So "best for this control" is true. Any control that runs on at corners
/// has corner feeds.
/// @param had    the controller's own settings
/// @param asked  with the task's keys
/// @throws InputError at the key
void refuse_beyond_controller(const std::optional<toml_input::Table>& design, const toml_input::Table& controller,
                              const ControllerSettings& had, const ControllerSettings& asked);

}  // namespace accdec
