#pragma once

#include <accdec/task/task.hpp>

namespace accdec {

/// Whether for a given order, delays and samples the filters that hold all limits are a convex set: no axis bounds
/// power or regeneration, no corner asks for a smallest speed.
bool is_convex(const Task& task);

}  // namespace accdec
