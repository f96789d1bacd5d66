#pragma once

#include <functional>
#include <optional>
#include <string>

#include <accdec/plan/run/cool_profiles.hpp>
#include <accdec/program.hpp>

namespace accdec {

/// The time of a plan made beside another; 0 without one.
PlanTime time_of(const ProgramResult& result);

/// @throws std::invalid_argument with the result's message if it has no plan: then there is nothing to print
void require_plan(const ProgramResult& result, const Deadline& deadline);

/// Whether one filter is planned beside plan profiles: not for the longest programs, and when the time is over only for
/// short ones.
bool time_for_one_filter(const Toolpath& path, const Deadline& deadline);

/// Plan profiles, or a faster one. Programs of up to `several_plans_max` blocks are also planned with one filter, and
/// their arcs by a motion along them (plan free). The answer is the fastest of the plans that hold all limits, with the
/// times of the others as its candidates.
/// If none holds, it is the plan profiles with a message.
/// @param options  for the plan beside it
/// @param tell     one line a step, may be empty
/// @throws std::invalid_argument as run_profiles, and for Feeds::keep, because its ramps choose the feeds
ProgramResult run_fastest_plan(const ProgramFile& file, const Task& task, const ProgramFileOptions& options,
                               const std::function<void(const std::string&)>& tell);

/// Plan profiles of a program, with its lower bound.
/// @param cool  see run_profiles
ProgramResult plan_profiles_of(PlanningProblem problem, std::optional<CoolProfiles>* cool = nullptr);

/// As above, in the part of the time that it has in every plan: the plans that go on from it are never slower.
ProgramResult plan_profiles_first(const ProgramFile& file, const Task& task, const Deadline& deadline,
                                  std::optional<CoolProfiles>* cool = nullptr);

/// Whether bounds of corners are made: for programs of up to `several_plans_max` blocks, as longer ones take longer to
/// bound than to plan. Bounds know no contour, so every corner needs a tolerance.
bool has_bounds(const Toolpath& path);

/// Bounds of corners, for sums of monotone legs and for any motion, whichever plan, see has_bounds.
/// @param deadline  each bound has 15 % of what is left, 10 s if there is no limit; those cut short say so
/// @param thorough  see any_motion_bound
CornerBound corner_bound_of(const Toolpath& path, const Task& task, const Deadline& deadline = {},
                            bool thorough = false);

/// Bounds of the path that an answer runs along. Longer chords cut more off an arc: bounds of a finer reading do not
/// hold for a plan that read its arcs again.
/// @param known   bounds of the program as it was first read
/// @param chords  m, of that reading from their arcs
CornerBound corner_bound_as_read(const CornerBound& known, double chords, const ProgramResult& answer, const Task& task,
                                 ProgramFileOptions options);

}  // namespace accdec
