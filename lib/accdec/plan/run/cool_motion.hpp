#pragma once

#include <functional>
#include <optional>
#include <string>

#include <accdec/plan/run/cool_profiles.hpp>
#include <accdec/program.hpp>

namespace accdec {

/// The motion of plan free of a program whose drives have ratings: shortened at lower and lower limits, until its
/// drives are cool.
/// @param profiles  plan profiles  @param limits  the lower limits of it, none: it is cool without
/// @param fixed  one filter that holds; may be nullptr
/// @returns none if nothing cool is faster than both plans
std::optional<ProgramResult> cool_motion(const ProgramFile& file, const ProgramResult& profiles,
                                         const std::optional<CoolProfiles>& limits, const ProgramResult* fixed,
                                         const Task& task, const ProgramFileOptions& options,
                                         const std::function<void(const std::string&)>& tell);

}  // namespace accdec
