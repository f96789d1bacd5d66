#pragma once

#include <cstdint>
#include <map>
#include <span>

#include <accdec/plan/verify/used_limits.hpp>
#include <accdec/simulate/direct.hpp>

// Internal: the verifier's own formulas of what a program's motion does to its path, and of what it leaves vibrating.

namespace accdec {

/// The use of Toolpath::contour_max by the steps of a motion. References are kept.
/// @param order  of the longest filter of the motion
UseOfLimit use_of_contour(const DirectMotion& motion, const Toolpath& path, int order);

/// The largest distance in m of a step from the nearest of blocks first .. last.
double off_blocks(const Toolpath& path, std::size_t first, std::size_t last, const ProgramPoint& from,
                  const ProgramPoint& to);

/// The largest distances of a motion from the lines of straight legs, m, by the line of the program that the leg begins
/// in: LegError says which samples count. @param order  of the longest filter of the motion  @param felt  as far as
/// legs before are felt
std::map<std::uint32_t, double> off_legs(const DirectMotion& motion, const Toolpath& path, int order, int felt);

/// The use of a mode of an axis, wherever the motion goes on evenly or stops, and before every corner of what was left
/// by then. The oscillator is followed sample by sample from hit to hit of the command, and the taps add up what they
/// make of it.
/// @param command  its motion, whose samples count; the reference is kept  @param filter  of the command
UseOfLimit use_of_mode(const DirectMotion& command, const Toolpath& path, double period, std::span<const int> delays,
                       const Filter& filter, const Mode& mode);

}  // namespace accdec
