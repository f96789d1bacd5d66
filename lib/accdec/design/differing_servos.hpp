#pragma once

#include <accdec/design.hpp>

namespace accdec {

/// A design for axes that respond differently, or by negative taps. It is made as if all axes had the servo of one of
/// them, for each in turn. Its delays are then changed until the task's own verifier accepts it. Nothing is proved.
DesignResult design_differing(const Task& task, const DesignOptions& options);

}  // namespace accdec
