#pragma once

#include <accdec/task.hpp>

namespace accdec {

/// Whether the filters that hold all limits, for a given order, delays and samples, are a convex set. They are if no
/// axis bounds power or regeneration and no corner has a smallest speed.
bool is_convex(const Task& task);

}  // namespace accdec
