#pragma once

#include <functional>
#include <optional>
#include <string>

#include <accdec/plan/run/along_plan.hpp>
#include <accdec/program.hpp>

namespace accdec {

/// `accdec program --plan free`: the fastest of plan profiles, its arcs planned along the path (along_plan.hpp), and
/// one filter, shortened by convex programs over its samples. Verified; where nothing is gained, or the check of all
/// samples refuses it, the answer is the plan it began with. Programs of up to `several_plans_max` blocks are also
/// planned with one filter; if that is faster, it is the answer.
/// @param tell  one line a step, may be empty
/// @param fixed  plan fixed, with a motion that holds, if it is known; else it is made in a part of the time
/// @throws std::invalid_argument for a limit that this plan does not keep, by name, and for options that it does not
///         take
ProgramResult run_free_plan(const ProgramFile& file, const Task& task, const ProgramFileOptions& options,
                            const std::function<void(const std::string&)>& tell,
                            std::optional<ProgramResult> fixed = {});

/// The motion of plan free from plans that are known. Only `options.deadline` ends it by the clock.
/// @param profiles  plan profiles, may be without a plan: the answer where there is no faster motion
/// @param along  its arcs planned along the path, if that is faster (plan_along)
/// @param fixed  one filter that holds; may be nullptr
ProgramResult free_from(const Toolpath& path, const ProgramResult& profiles, std::optional<AlongPlan> along,
                        const ProgramResult* fixed, const Task& task, const ProgramFileOptions& options,
                        const std::function<void(const std::string&)>& tell);

}  // namespace accdec
