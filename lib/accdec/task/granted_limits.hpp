#pragma once

#include <accdec/task/task.hpp>
#include <accdec/task/verifier.hpp>

namespace accdec {

/// Relative part by which a proof widens limits: what the verification grants, and as much again for the rounding of
/// its simulation.
inline constexpr double granted_tolerance = 2.0 * verification_tolerance;

/// The task whose limits, held exactly, are all that the verification could take for held: what "nothing is shorter"
/// and "there is no design" are proved of. Every limit is wider by `granted_tolerance`; corner errors are at least
/// `position_floor` and residuals 1e-12, below which a simulation cannot tell them from nothing.
Task granted_limits(Task task);

}  // namespace accdec
