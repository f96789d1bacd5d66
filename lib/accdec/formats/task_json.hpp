#pragma once

#include <string>
#include <string_view>

#include <accdec/formats/task_reader.hpp>
#include <accdec/task/task.hpp>

namespace accdec {

/// Reads a task from JSON: an object with the tables and keys of a task file, [[axis]], [[corner]] and [[mode]] as
/// lists of objects. Beside every key that ends in a unit its name without it is taken, in SI: angle (rad) for
/// angle_deg, feed_in (m/s) for feed_in_mm_min, error_max (m), velocity_max (m/s), sample_period (s), delay
/// (samples)... A value in SI is converted so that it comes back to the last bit, wherever some number in the key's
/// unit does.
/// @param name  stands for a file in messages
/// @throws InputError  as parse_task, without lines; for text that is no JSON object; for a key given both ways
Task parse_task_json(std::string_view json, const std::string& name, const TaskOptions& options = {});

/// The task with one number changed, or one for all axes, corners or modes.
/// @param key    as studies write it, "filter.order" or "corner.*.error_max_um", or in SI, "corner.A.error_max"
/// @throws std::invalid_argument if the task has no such key, axis, corner or mode; InputError if the value is not
/// allowed
Task with_setting(const Task& task, const std::string& key, double value);

}  // namespace accdec
