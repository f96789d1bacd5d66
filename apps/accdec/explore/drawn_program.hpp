#pragma once

#include <cstdint>
#include <vector>

#include <nlohmann/json.hpp>

#include <accdec/program.hpp>

namespace accdec::explore {

inline constexpr double mm = 1e3;  ///< of a metre

/// mm to four digits behind the point: 0.1 um can be seen nowhere.
double rounded(double x);

/// How many samples a point of every plan stands for: one number, so that their points are at the same times.
std::int64_t common_step(const std::vector<ProgramResult>& plans);

/// The motion of a plan in the units of people, every n-th sample of it: times, places, speeds, and the limit that
/// bound most since the one before. `loads` are curves of force and power of every axis that carries a load, and of all
/// axes where they share a supply. Accelerations, jerks and loads are the largest since the one before.
/// @param programmed  the path as the program has it
/// @param machine     as many axes as the path
/// @param step        n
nlohmann::ordered_json motion_json(const Toolpath& programmed, const Machine& machine, const ProgramResult& result,
                                   std::int64_t step);

}  // namespace accdec::explore
