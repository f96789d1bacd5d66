#pragma once

#include <functional>
#include <vector>

#include <accdec/bounds/tube_window.hpp>
#include <accdec/machine.hpp>
#include <accdec/program.hpp>

namespace accdec {

/// A straight leg from joint to joint.
struct WeightLeg {
  TubeLeg tube;
  double way = 0.0;        ///< s, at its pace
  double tolerance = 0.0;  ///< m, of the joint at its end
  std::size_t last = 0;    ///< its last block
};

/// A time that no motion over legs undercuts from rest to rest, s; 0 if none is found. All corners are seen together,
/// so it is close to what the fastest motion takes (weighted_time, largest_weighted_time). Joints are left out where
/// legs are hardly longer than tolerances: legs around them become one, with a wider tube.
/// @param known  s, a bound or a time that helps to guess  @param work_left  see largest_weighted_time
/// @param proof  receives the legs and weights of that time, without its first block; may be nullptr
double weight_bound(const std::vector<WeightLeg>& legs, const Machine& machine, std::size_t dimensions, double known,
                    double& work_left, const std::function<bool()>& more, MotionProof* proof = nullptr);

}  // namespace accdec
