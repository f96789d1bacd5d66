#pragma once

#include <vector>

#include <accdec/files.hpp>
#include <accdec/filter.hpp>
#include <accdec/simulate.hpp>
#include <accdec/simulate/sample_check.hpp>

namespace accdec {

/// A program for a controller that takes a position in every cycle: every corner has its own filter and speed, every
/// leg its own ramps.
struct ProfilePlan {
  ProfileChain chain;
  Filter last{{1.0}};          ///< that the samples pass last, see LastFilter; a single tap: none
  std::vector<double> errors;  ///< m, of the joint at the end of every block, from the samples
  SampleCheck check;           ///< of every sample
  int rounds = 0;              ///< of repair
  bool checked = false;        ///< to the last sample; else there is no plan
  bool holds() const { return check.limits_hold && check.errors_hold; }
};

/// Plans, samples and verifies. If samples break a limit or a tolerance, that corner or leg is planned more slowly and
/// everything is verified again. `holds` tells whether anything is still broken after that.
///
/// Velocity, acceleration, tolerances without a last filter, and vibration bounds always hold. The samples pass a last
/// filter that holds the vibration bounds for any command. With a jerk limit, the last filter is a boxcar of about
/// a_max/j_max. Several are tried, and the fastest verified plan is kept. For some limits the plan uses values that
/// nearly always hold, and repairs the rest. These are jerk and tolerances where legs are shorter than the last filter,
/// and force, power and regeneration.
/// @param machine  as many axes as the path, or none
/// @throws std::invalid_argument if no last filter within two and a half periods of the slowest mode holds the
///         vibration bounds
/// @param deadline  ends repair and further filters: what is returned then may not hold, or is not checked
ProfilePlan plan_profiles(const Toolpath& path, const Machine& machine, double sample_period,
                          const Deadline& deadline = {});

}  // namespace accdec
