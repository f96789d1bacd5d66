#pragma once

#include <span>
#include <vector>

namespace accdec {

/// Squared size of a signal's Fourier transform, at whole multiples of `step`.
struct PowerSpectrum {
  double step = 0.0;          ///< Hz
  std::vector<double> power;  ///< from 0 Hz to half the sample rate; the count is a power of two
  double end() const { return step * static_cast<double>(power.size()); }
};

/// The spectrum of a signal without its mean, followed by at least as many zeros.
PowerSpectrum power_spectrum(std::span<const double> signal, double period);

/// Sums over `cells` equal parts of the frequencies up to `most`, Hz.
std::vector<double> summed_power(const PowerSpectrum& spectrum, double most, int cells);

/// How a signal resembles itself some time later, from a band of its spectrum.
struct Autocorrelation {
  double period = 0.0;         ///< s, of the lags; longer than that of the signal
  std::vector<double> values;  ///< of lags 0, 1 ..
};
/// @param low, high  Hz: below and above, the spectrum fades out, within 0 .. low and high .. 1.6 high
/// @param longest  s, the last lag
Autocorrelation autocorrelation(const PowerSpectrum& spectrum, double low, double high, double longest);

}  // namespace accdec
