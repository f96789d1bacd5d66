#pragma once

#include <accdec/filter.hpp>

namespace accdec {

/// The same shape in `count` >= 1 taps: the step response, linear between its samples, over count instead of N + 1
/// samples.
Filter stretched(const Filter& filter, int count);

}  // namespace accdec
