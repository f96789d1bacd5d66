#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <accdec/plan/along/straight_run.hpp>
#include <accdec/plan/free/free_path.hpp>

namespace accdec {

/// The beginning of a leg: the last two steps of the motion before it, m, rows; the later one first.
struct LegStart {
  std::vector<double> steps;
  bool rest = true;  ///< all steps are 0
};

/// A motion along a straight leg in so many samples, by a linear program over them: velocity, acceleration, jerk, and
/// force with viscous friction. It begins behind the given steps and ends at rest; its first differences see both.
/// At full speed one step may stand for many.
/// @param way  m, of every sample of a motion along the leg, from 0 to its length: the search begins there
/// @returns the part of the way that is done at every sample, 0 .. 1; none if there is no such motion, or none is found
std::optional<std::vector<double>> leg_in(const FreePath& free, const StraightLeg& leg, const LegStart& start,
                                          const std::vector<double>& way, std::size_t count);

/// The same from rest to rest by three averages of a step as long as the leg. Their limits hold to rounding, so that
/// legs of round figures take whole numbers of samples.
/// @returns none with a limit of force
std::optional<std::vector<double>> averaged_leg(const FreePath& free, const StraightLeg& leg);

}  // namespace accdec
