#pragma once

#include <string>

#include <accdec/certificate.hpp>
#include <accdec/task.hpp>

// Internal: what the exact method knows of a task.

namespace accdec {

/// The task without the limits that the exact method does not know.
Task covered_part(const Task& task);

/// The limits of a task that its covered part leaves out, in words; empty if there are none.
std::string left_out(const Task& task);

/// The meaning of such a task's bound, for people. @param proof  of the bound; null: there is none
/// @param finished  whether the search for it was
std::string what_bound(const Task& task, const Certificate* proof, bool finished);

}  // namespace accdec
