#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include <accdec/task/task.hpp>

namespace accdec {

/// A task as JSON with the keys and units of the task file, every axis written out: reading it back gives the same task
/// to the last bit (numbers are chosen so that their conversion to SI gives the very value).
nlohmann::ordered_json task_to_json(const Task& task);

/// The same as a task file.
std::string task_to_toml(const Task& task);

}  // namespace accdec
