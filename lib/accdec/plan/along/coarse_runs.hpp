#pragma once

#include <accdec/files.hpp>
#include <accdec/plan/free/free_motion.hpp>

namespace accdec {

/// The same motion with its runs between stops as cubic splines, wherever they are faster. Their control points are a
/// motion of half as many samples, which is shortened like any other. Bounds on the differences of control points bound
/// the derivatives of the spline, and so the differences of its samples. A window of control points is twice as long in
/// time. Control points are made of control points again, as long as the tolerances of the path have room.
/// @param report  its programmes and iterations grow
/// @param deadline  ends it with the best motion so far
FreeSamples with_coarse_runs(const FreePath& free, const FreeSamples& motion, const FreeOptions& options,
                             const Deadline& deadline, FreeReport& report);

}  // namespace accdec
