#pragma once

#include <vector>

#include <accdec/program/profiles/chain.hpp>
#include <accdec/program/profiles/check.hpp>
#include <accdec/program/read/toolpath.hpp>

namespace accdec {

/// A program for a controller that takes a position every cycle: every corner with its own filter and speed, every leg
/// with its own ramps.
struct ProfilePlan {
  ProfileChain chain;
  int taps = 1;                ///< of the boxcar that the samples pass last, for the jerk limit; 1: none
  std::vector<double> errors;  ///< m, of the joint at the end of every block, from the samples
  SampleCheck check;           ///< of every sample
  int rounds = 0;              ///< of repair
  bool holds() const { return check.limits_hold && check.errors_hold; }
};

/// Plans, samples and verifies. Where samples break a limit or a tolerance nevertheless, that corner or leg is planned
/// slower and everything verified again; what still breaks one after that is said by `holds`.
///
/// Velocity, acceleration, jerk and tolerances without a jerk limit hold by construction. With a jerk limit the samples
/// pass a boxcar of about a_max/j_max; several lengths are tried and the fastest kept. Jerk where legs are shorter than
/// that boxcar, tolerances there, force, power and regeneration are planned with what holds nearly always, and
/// repaired.
/// @param machine  as many axes as the path, or none; no vibration bounds, see profiles_refusal
/// @throws std::invalid_argument for vibration bounds
ProfilePlan plan_profiles(const Toolpath& path, const Machine& machine, double sample_period);

}  // namespace accdec
