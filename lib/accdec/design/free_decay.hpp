#pragma once

#include <span>
#include <vector>

#include <accdec/design/decay_fit.hpp>

namespace accdec {

/// A vibration that dies away behind jolts.
struct DecayMode {
  double frequency = 0.0;  ///< Hz, without damping
  double damping = 0.0;    ///< damping ratio
  double energy = 0.0;     ///< of its part in the signal, squares summed over the samples
  DecayError error{};
  bool goes_on = true;  ///< it stands out a period behind the jolts, too
};

/// Free vibrations behind jolts.
struct FreeDecay {
  std::vector<DecayMode> modes;  ///< the strongest first
  double energy = 0.0;           ///< of the stretches that were used
  int jolts = 0;
  int overlaps = 0;  ///< jolts before which the last ringing had not died away
};

/// Finds jolts, and fits the stretches between them by sums of damped vibrations (`DecayFit`). So a jolt may come
/// before the last ringing ends. Jolts are where no sum of the vibrations found fits; they are found again with each
/// better fit. A mode counts if noise would seldom fit as well: in one log of a thousand. There are no modes if the
/// signal is not mainly such stretches. There are none either if what is left is louder near the modes than elsewhere:
/// then something shakes the machine between the jolts.
FreeDecay free_decay(std::span<const double> signal, double period, const DecaySearch& search);

/// The vibrations behind one jolt that is known. @param begin  the first sample behind it
/// @param shown  limits of what counts as a mode; others are fitted, too
FreeDecay decay_behind(const std::vector<double>& values, double period, std::size_t begin, const DecaySearch& search,
                       const DecaySearch& shown);

}  // namespace accdec
