#pragma once

#include <accdec/design.hpp>

namespace accdec {

/// A design for axes that respond differently, or by negative taps. Standard shapes come first. Filters are then
/// designed as if all axes had the servo of one of them, for each in turn, and by a nonlinear solver that knows every
/// servo. Each gets its smallest delays, and the best is the answer. Nothing is proved of other filters.
DesignResult design_differing(const Task& task, const DesignOptions& options);

}  // namespace accdec
