#pragma once

#include <accdec/machine.hpp>

// Internal to the room: the verifier's own simulation of what a mode is left with.

namespace accdec {

/// Amplitude left after the last tap in an oscillator that the taps hit one after another. It is 1 for a single hit by
/// the whole sum. @param frequency  of the oscillator without damping, Hz  @param period  s
double amplitude_left(const Filter& filter, double frequency, double damping, double period);
/// Use of a mode's bound by the filter of the command.
LimitUse verified_vibration(const Filter& filter, const Mode& mode, double period);

}  // namespace accdec
