#pragma once

#include <accdec/task.hpp>

namespace accdec {

/// Whether the filters that hold all limits, for a given order, delays and samples, are a convex set. They are if no
/// axis bounds power or regeneration, no corner has a smallest speed, and no supply is shared. If an axis with dry
/// friction reverses, the sample at which it does is one of the samples given.
bool is_convex(const Task& task);

}  // namespace accdec
