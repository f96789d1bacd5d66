#pragma once

#include <string>
#include <string_view>

#include <accdec/task.hpp>

namespace accdec {

/// Reads a task from JSON: an object with the tables and keys of a task file, [[axis]], [[corner]] and [[mode]] as
/// lists of objects. A key that ends in a unit may also be given in SI, by its name without the unit. Examples are
/// angle (rad) for angle_deg, feed_in (m/s) for feed_in_mm_min, error_max (m), velocity_max (m/s), sample_period (s),
/// and delay (samples). Rotary axes are in rad, kg m^2 (inertia) and N m (torque_max). A value in SI is converted so
/// that it reads back exactly, if any number in the key's unit does.
/// @param name  used as the file's name in messages
/// @throws InputError as parse_task, without lines; also for text that is not a JSON object, and for a key given in
/// both ways
Task parse_task_json(std::string_view json, const std::string& name, const TaskOptions& options = {});

/// The task with one number changed, for one place or for all axes, corners or modes.
/// @param key  as in studies, "filter.order" or "corner.*.error_max_um", or in SI, "corner.A.error_max"
/// @throws std::invalid_argument if the task has no such key, axis, corner or mode; InputError if the value is not
/// allowed
Task with_setting(const Task& task, const std::string& key, double value);

}  // namespace accdec
