#pragma once

#include <vector>

#include <accdec/design/free_decay.hpp>
#include <accdec/design/power_spectrum.hpp>

namespace accdec {

/// The modes that most model orders of a log's autocorrelation find, the strongest first; energies are parts of the
/// power. Their errors are how model orders differ, which no theory bounds.
std::vector<DecayMode> lag_modes(const PowerSpectrum& spectrum, double seconds, const DecaySearch& search);

}  // namespace accdec
