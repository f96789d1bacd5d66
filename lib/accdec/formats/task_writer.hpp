#pragma once

#include <nlohmann/json_fwd.hpp>

#include <accdec/task.hpp>

namespace accdec {

/// A task as JSON with the keys and units of the task file, with every axis written out. Reading it back gives exactly
/// the same task: numbers are chosen so that their conversion to SI gives the same value.
nlohmann::ordered_json task_to_json(const Task& task);

}  // namespace accdec
