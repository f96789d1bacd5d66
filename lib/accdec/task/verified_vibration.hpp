#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <accdec/machine.hpp>
#include <accdec/task.hpp>
#include <accdec/task/simulation.hpp>

// Internal to the room: the verifier's own simulation of what a mode is left with.

namespace accdec {

/// Amplitude left after the last hit in an oscillator that is hit once a sample. It is 1 for a single hit of 1.
/// @param frequency  of the oscillator without damping, Hz  @param period  s
double amplitude_left(std::span<const double> hits, double frequency, double damping, double period);
/// Use of a mode's bound by the filter of the command.
LimitUse verified_vibration(const Filter& filter, const Mode& mode, double period);

/// The changes of an axis' velocity in one event, m/s, from its first sample to the last that changes anything.
/// @param order  of the command's filter  @param legs  of the corner, to tell whether leg 2 moves the axis
std::vector<double> velocity_changes(const SampledMotion& motion, Event event, std::size_t axis, int order, int delay,
                                     const Corner& legs);
/// The displacement that those changes leave a mode of the axis with, m.
double displacement_left(std::span<const double> changes, double frequency, double damping, double period);
/// Use of the bound of a mode of an axis by those changes, with its worst frequency and damping.
LimitUse verified_residual(std::span<const double> changes, const Mode& mode, double period);

/// Changes of an axis' velocity in a program before they pass the command's filter.
struct RawChanges {
  std::vector<std::pair<std::int64_t, double>> hits;  ///< sample and m/s; samples ascend
  std::vector<std::size_t> judged;  ///< hits behind which the motion may go on as if nothing came later; ascending
};
/// The displacement, m, that each judged hit and those before it leave a mode with when they have passed the filter.
std::vector<double> displacements_left(const RawChanges& changes, const Filter& filter, double frequency,
                                       double damping, double period);
/// The largest of them for a mode of an axis, with its worst frequency and damping.
LimitUse verified_residual(const RawChanges& changes, const Filter& filter, const Mode& mode, double period);

/// Use of the bound of a mode of an axis at one corner: the worst of its three events.
/// @param order  of the command's filter
LimitUse verified_residual(const SampledMotion& command, const Mode& mode, const Machine& machine,
                           const TaskCorner& corner, int order, int delay, double period);

}  // namespace accdec
