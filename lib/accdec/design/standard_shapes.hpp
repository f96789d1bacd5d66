#pragma once

#include <array>
#include <optional>
#include <vector>

#include <accdec/task/result.hpp>
#include <accdec/task/task.hpp>

namespace accdec {

/// The shapes a standard controller offers, each with its own free parameters; in the order tables and figures list
/// them.
inline constexpr std::array<Shape, 6> standard_shapes{Shape::boxcar, Shape::trapezoid, Shape::s_curve,
                                                      Shape::hann,   Shape::blackman,  Shape::blackman_sinc};

/// Cut-offs tried for a Blackman-sinc of order N: 2/N * j/20, j = 1 .. 20. At the largest the sinc's first zeros fall
/// on the window's ends (the paper's 0.049 at N = 40 is 0.98 of it); towards zero the shape becomes the Blackman
/// window.
inline constexpr int blackman_sinc_cutoffs = 20;

struct StandardShapeResult {
  std::optional<FilterSpec>
      spec;             ///< the filter in the words of a task file; none when no order within the task's bounds will do
  DesignResult result;  ///< feasible (the family's best, verified by simulation), infeasible or failed; its task has
                        ///< the filter in place
};

/// The best that one standard shape can do under a task's limits: over every order within the task's bounds and the
/// shape's parameter (ramp of a trapezoid, cut-off of a Blackman-sinc) the shortest cycle time, each corner with the
/// smallest delay at which its error bound and all limits hold. Exhaustive over orders, ramps and the cut-offs named
/// above; of equal cycle times the lowest order counts. The task's own filter, if any, is ignored; given delays stay.
/// @throws std::invalid_argument for Shape::taps.
StandardShapeResult best_standard_shape(const Task& task, Shape shape);

}  // namespace accdec
