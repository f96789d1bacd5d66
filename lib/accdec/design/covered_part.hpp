#pragma once

#include <string>

#include <accdec/task.hpp>

// Internal: what the exact method knows of a task.

namespace accdec {

/// The task without the limits that the exact method does not know.
Task covered_part(const Task& task);

/// The limits of a task that its covered part leaves out, in words; empty if there are none.
std::string left_out(const Task& task);

}  // namespace accdec
