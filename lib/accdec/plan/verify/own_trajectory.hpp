#pragma once

#include <vector>

#include <accdec/machine.hpp>
#include <accdec/simulate.hpp>

namespace accdec {

/// The samples of a trajectory as the verifier judges them. They share no formula with the planner: neither with
/// `axis_loads` nor with PathContour.
struct OwnTrajectory {
  double contour = 0.0;  ///< m, largest distance of the polyline through the samples from the blocks; if it is bounded
  std::vector<double> rms;  ///< N, root mean square of the force of every axis over the program, rests included
};
/// @param plan  a trajectory  @param machine  as many axes as its path, or none
OwnTrajectory own_trajectory(const Plan& plan, double sample_period, const Machine& machine);

}  // namespace accdec
