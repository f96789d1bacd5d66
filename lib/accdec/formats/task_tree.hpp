#pragma once

#include <string>

#include <toml++/toml.h>

#include <accdec/task.hpp>

// Internal to this folder: the reader behind parse_task, for trees from other sources (the `task` of a result file).

namespace accdec {

/// @param file  named in messages
/// @param pointer  where the tree stands in its file, "" for the top
Task task_from_tree(const toml::table& tree, const std::string& file, const std::string& pointer,
                    const TaskOptions& options);

}  // namespace accdec
