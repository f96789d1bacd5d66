#pragma once

#include <optional>

#include <accdec/design.hpp>

namespace accdec {

/// A design at a period several times as long, brought to the task's own period. The exact method is fast for filters
/// of few taps. With many taps, its first designs are far from the best where limits are not convex.
///
/// The long filter's cumulative response is read in between its samples. That keeps velocity and acceleration. A moving
/// average of a long period behind it keeps the jerk. If limits still break, the filter is stretched a little. The
/// result is verified at the task's period.
/// @param known_order  of a filter that holds all limits; 0: none is known
/// @return none if the task needs few taps, fixes them, or has a response that is measured at its period
std::optional<DesignResult> coarse_design(const Task& task, const DesignOptions& options, double seconds,
                                          int known_order = 0);

}  // namespace accdec
