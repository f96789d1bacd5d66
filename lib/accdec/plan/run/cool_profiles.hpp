#pragma once

#include <optional>

#include <accdec/files.hpp>
#include <accdec/plan/trajectory/plan_profiles.hpp>
#include <accdec/program.hpp>

namespace accdec {

/// Plan profiles at lower feeds and accelerations than the program and the task allow.
struct CoolProfiles {
  Toolpath path;    ///< with lower feeds
  Machine machine;  ///< with lower accelerations and velocities
  ProfilePlan plan;
  std::int64_t samples = 0;
  double excess = unlimited;  ///< see Cooling
};

/// Lowers all feeds and limits as if time went by more slowly by a factor above 1.
void slow_down(Toolpath& path, Machine& machine, double factor);

/// Lowers feeds and the accelerations of axes until no drive is warmer over the program than its rating.
/// @param plan  that holds all limits
/// @returns none if all drives are cool, or nothing cool was found
std::optional<CoolProfiles> cool_profiles(const Toolpath& path, const Machine& machine, double sample_period,
                                          const ProfilePlan& plan, const Deadline& deadline);

/// As run_profiles. @param cool  the lower limits of a plan that would be too warm without them
ProgramResult run_profiles(PlanningProblem problem, std::optional<CoolProfiles>& cool);

}  // namespace accdec
