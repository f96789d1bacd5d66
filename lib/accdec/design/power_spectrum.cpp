#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>

#include <unsupported/Eigen/FFT>

#include <accdec/design/power_spectrum.hpp>

namespace accdec {
namespace {

/// From 1 at 0 to 0 at 1.
double fading(double x) {
  return 0.5 + 0.5 * std::cos(std::numbers::pi * std::clamp(x, 0.0, 1.0));
}

}  // namespace

PowerSpectrum power_spectrum(std::span<const double> signal, double period) {
  std::size_t size = 2;
  while (size < 2 * signal.size()) size *= 2;
  const double mean =
      std::accumulate(signal.begin(), signal.end(), 0.0) / std::max(1.0, static_cast<double>(signal.size()));
  std::vector<double> padded(size, 0.0);
  std::transform(signal.begin(), signal.end(), padded.begin(), [&](double x) { return x - mean; });
  std::vector<std::complex<double>> transformed;
  Eigen::FFT<double> fft;
  fft.fwd(transformed, padded);
  PowerSpectrum spectrum{1.0 / (period * static_cast<double>(size)), std::vector<double>(size / 2)};
  for (std::size_t i = 0; i < size / 2; ++i) spectrum.power[i] = std::norm(transformed[i]);
  return spectrum;
}

std::vector<double> summed_power(const PowerSpectrum& spectrum, double most, int cells) {
  std::vector<double> sums(static_cast<std::size_t>(cells), 0.0);
  for (std::size_t i = 0; i < spectrum.power.size(); ++i) {
    const double at = static_cast<double>(i) * spectrum.step / most * cells;
    if (at < cells) sums[static_cast<std::size_t>(at)] += spectrum.power[i];
  }
  return sums;
}

Autocorrelation autocorrelation(const PowerSpectrum& spectrum, double low, double high, double longest) {
  // As many frequencies as the band needs: the fewer, the longer are the lags.
  std::size_t count = spectrum.power.size();
  while (count > 2 && spectrum.step * static_cast<double>(count / 2) >= 1.6 * high) count /= 2;
  std::vector<std::complex<double>> both(2 * count, 0.0), lags;
  for (std::size_t i = 1; i < count; ++i) {
    const double f = spectrum.step * static_cast<double>(i);
    both[i] = both[2 * count - i] = spectrum.power[i] * fading((low - f) / low) * fading((f - high) / (0.6 * high));
  }
  Eigen::FFT<double> fft;
  fft.inv(lags, both);
  Autocorrelation result{0.5 / (spectrum.step * static_cast<double>(count)), {}};
  const auto wanted = std::min(count, static_cast<std::size_t>(longest / result.period) + 1);
  for (std::size_t k = 0; k < wanted; ++k) result.values.push_back(lags[k].real());
  return result;
}

}  // namespace accdec
