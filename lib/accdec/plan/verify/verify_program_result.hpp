#pragma once

#include <optional>
#include <string>
#include <vector>

#include <accdec/program.hpp>
#include <accdec/simulate/direct.hpp>

namespace accdec {

/// The report of `accdec verify` on a program's result.
struct ProgramResultCheck {
  bool accepted = false;
  std::vector<std::string> reasons;  ///< reasons for rejecting it
  std::string shown;                 ///< the simulation in words
  ProgramResult found;               ///< the values that follow from the commands, as they should be recorded
};

/// Makes the motion of the plan that a result records once more, and with it all that follows from the plan: `found`.
/// The bounds on the time, counts of the program and times of other plans do not follow from it.
///
/// A command (its path, feeds, delays and filter) is simulated by direct_motion. Errors of joints are compared with
/// their tolerances and records. So are bound, value, use and place of every axis limit over all samples, vibration
/// bounds, and the filter with the task's. Behind a servo, errors and loads are those of its own loop (behind_servos).
/// The tolerance is relative 1e-7, or 1e-9 m: two summations round differently.
/// The samples of a trajectory are checked by SampleChecker, from their positions alone.
/// @param task     the result's own
/// @param filters  of the command's blocks, in results of earlier versions; else none
ProgramResultCheck verify_program_result(const ProgramResult& result, const Task& task,
                                         const std::optional<BlockFilters>& filters = std::nullopt);

/// Checks every sample of a trajectory as above, and that a free motion keeps its tubes, feeds, stops and dwells
/// (TubeCheck).
/// Fills in errors, uses of limits, times and the verdict. Empty if all holds, else what does not.
std::string judge_trajectory(ProgramResult& result, const Machine& machine);

}  // namespace accdec
