#pragma once

#include <vector>

#include <accdec/motion/filter.hpp>
#include <accdec/program/profiles/chain.hpp>
#include <accdec/program/profiles/sample_check.hpp>
#include <accdec/program/read/toolpath.hpp>

namespace accdec {

/// A program for a controller that takes a position every cycle: every corner with its own filter and speed, every leg
/// with its own ramps.
struct ProfilePlan {
  ProfileChain chain;
  Filter last{{1.0}};          ///< that the samples pass last, see LastFilter; a single tap: none
  std::vector<double> errors;  ///< m, of the joint at the end of every block, from the samples
  SampleCheck check;           ///< of every sample
  int rounds = 0;              ///< of repair
  bool holds() const { return check.limits_hold && check.errors_hold; }
};

/// Plans, samples and verifies. Where samples break a limit or a tolerance nevertheless, that corner or leg is planned
/// slower and everything verified again; what still breaks one after that is said by `holds`.
///
/// By construction hold velocity, acceleration, tolerances without a last filter, and vibration bounds: the samples
/// pass a last filter that holds them, whatever is commanded. With a jerk limit the last filter is a boxcar of about
/// a_max/j_max; several are tried and the fastest verified plan is kept. Jerk where legs are shorter than the last
/// filter, tolerances there, force, power and regeneration are planned with what holds nearly always, and repaired.
/// @param machine  as many axes as the path, or none
/// @throws std::invalid_argument where no last filter within two and a half periods of the slowest mode holds the
///         vibration bounds
ProfilePlan plan_profiles(const Toolpath& path, const Machine& machine, double sample_period);

}  // namespace accdec
