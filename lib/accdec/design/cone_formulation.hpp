#pragma once

#include <vector>

#include <accdec/nlp/cone_problem.hpp>
#include <accdec/task.hpp>

namespace accdec {

/// Where a corner's error is bounded: its delay d and the sample k, both >= 0.
struct CornerPlace {
  int delay = 0, sample = 0;
};

/// Filters of at most this order at given delays and samples, the convex part of the design problem: variables b_0 ..
/// b_N and the excess e, which is minimised. The cones of the corners are |S[k]| <= error_max + e, for every corner
/// with a tolerance, in samples of its faster leg. The cones of vibration are the residuals at 8 frequencies per ripple
/// of each band. Acceleration, jerk and force are linear rows, divided by their bounds. A design at these places exists
/// exactly if e <= 0 is possible, apart from vibration between those frequencies.
/// @param at  one per corner
/// @throws std::invalid_argument for power, regeneration and smallest speeds, which are not convex, or when the number
/// of places is wrong
nlp::ConeProblem cone_problem(const Task& task, int order, const std::vector<CornerPlace>& at);

}  // namespace accdec
