#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace accdec {

/// A vibration that dies away behind jolts.
struct DecayMode {
  double frequency = 0.0;  ///< Hz, without damping
  double damping = 0.0;    ///< damping ratio
  double energy = 0.0;     ///< of its part in the signal, squares summed over the samples
};

/// Free vibrations behind jolts.
struct FreeDecay {
  std::vector<DecayMode> modes;  ///< the strongest first
  double energy = 0.0;           ///< of the stretches that were used
  int jolts = 0;
  int overlaps = 0;  ///< jolts before which the last ringing had not died away
};

/// The limits of a search for modes.
struct DecaySearch {
  double frequency_min, frequency_max;  ///< Hz
  double damping_max;
  std::size_t most;  ///< modes
};

/// Finds jolts, and fits the stretches between them by sums of damped vibrations with the same frequencies and damping
/// ratios, and with amplitudes of each stretch (variable projection: Golub, Pereyra, SIAM J. Numer. Anal. 10, 1973). So
/// a jolt may come before the last ringing ends. A mode counts if noise would seldom fit as well: in one log of a
/// thousand. There are no modes if the signal is not mainly such stretches.
FreeDecay free_decay(std::span<const double> signal, double period, const DecaySearch& search);

}  // namespace accdec
