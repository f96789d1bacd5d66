#pragma once

#include <vector>

#include <accdec/design/free_decay.hpp>
#include <accdec/design/power_spectrum.hpp>

namespace accdec {

/// Fits the spectrum of vibrations that noise keeps up, and of white noise on top. Each vibration adds
/// r (1 + s ((1 - cos v)/(1 - cos u) - 1))/|1 - 2 q cos(w_d T) e^(iv) + q^2 e^(2iv)|^2. Here v and u are the angles of
/// the power's and of the vibration's frequency, and q its decay in a sample. Powers are independent and exponentially
/// distributed. Their likelihood is largest at the answer (Whittle, J. R. Stat. Soc. B 15, 1953). A vibration counts if
/// the likelihood grows by more than chance gives in one log of a thousand.
/// @param seconds  length of the signal
/// @return the strongest first, with its standard errors; the energy is its part of that of the spectrum
std::vector<DecayMode> noise_modes(const PowerSpectrum& spectrum, double seconds, const DecaySearch& search);

}  // namespace accdec
