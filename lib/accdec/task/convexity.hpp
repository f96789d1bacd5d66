#pragma once

#include <accdec/task.hpp>

namespace accdec {

/// Whether the filters that hold all limits, for a given order, delays and samples, are a convex set. They are if no
/// axis bounds power or regeneration, no corner has a smallest speed, and no supply is shared. Dry friction of an axis
/// that reverses is not convex either.
bool is_convex(const Task& task);

/// Whether an axis with dry friction and a bounded force reverses at a corner.
bool friction_reverses(const Task& task);

}  // namespace accdec
