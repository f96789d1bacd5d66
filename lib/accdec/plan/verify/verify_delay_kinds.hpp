#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <accdec/program.hpp>
#include <accdec/simulate/direct.hpp>

namespace accdec {

/// Relative. Jerk is a third difference of positions that two summations round differently.
inline constexpr double rounding = 1e-7;
inline constexpr double position_rounding = 1e-9;  ///< m
inline constexpr std::size_t most_reasons = 20;    ///< for rejecting a result

/// Whether each delay of a result with settings is one that the task's control has, and the in-position width gives it.
/// @param filter   of the command, with the control's own smoothing
/// @param motion   of the command
/// @param reasons  takes what does not hold
void check_delay_kinds(const ProgramResult& result, const Task& task, const Filter& filter, const DirectMotion& motion,
                       std::vector<std::string>& reasons);

/// Whether each corner feed of a result with settings is a multiple of the control's step of both programmed feeds, or
/// all of both.
/// @param programmed  as it is read from the program, with the blocks whose commands the result has
/// @param reasons     takes what does not hold
void check_corner_feeds(const ProgramResult& result, const Task& task, const Toolpath& programmed,
                        std::vector<std::string>& reasons);

}  // namespace accdec
