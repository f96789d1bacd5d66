#pragma once

#include <functional>
#include <string>
#include <variant>

#include <accdec/program/write/profile_result.hpp>
#include <accdec/program/write/program_file.hpp>

namespace accdec {

/// Plan profiles of a program, with room in its tolerances for what chords leave of their arcs.
/// @param arc_tolerance  m, that the path was read with
ProfileResult plan_profiles_of(const std::string& name, Toolpath path, double arc_tolerance, const Task& task);

/// A bound of corners for whichever plan, for programs of up to `several_plans_max` blocks: of longer ones it would
/// take longer than their plan.
CornerBound corner_bound_of(const Toolpath& path, const Task& task);

/// `accdec program --plan profiles`: that plan, and beside it, of programs of up to `several_plans_max` blocks, those
/// of one filter and of one a leg; the fastest that holds all limits, with the times of the others as its candidates.
/// Where none holds, the plan profiles with a message.
/// @param file     as read; the feeds are chosen; its `reading` becomes that of the answer
/// @param options  for the plans beside it
/// @param tell     one line a step, may be empty
/// @throws std::invalid_argument as run_profiles
std::variant<ProfileResult, ProgramResult> run_fastest_plan(const std::string& name, ProgramFile& file,
                                                            const Task& task, const ProgramFileOptions& options,
                                                            const std::function<void(const std::string&)>& tell);

}  // namespace accdec
