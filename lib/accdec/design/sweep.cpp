#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include <unsupported/Eigen/FFT>

#include <accdec/design/power_spectrum.hpp>
#include <accdec/design/sweep.hpp>

namespace accdec {
namespace {

constexpr double piece = 0.4, apart = 3.0;    // s, of the log; Hz, from the line
constexpr double on_line = 0.8;               // of the pieces
constexpr double before = 0.5, behind = 4.0;  // s, of the jolt
constexpr std::size_t pieces_most = 400;

/// Frequency = begin + rate t.
struct Line {
  double rate, begin;
};

double median(std::vector<double> values) {
  const auto middle = values.begin() + std::ssize(values) / 2;
  std::ranges::nth_element(values, middle);
  return *middle;
}

/// The line through the loudest frequencies of pieces of the log, if it is one.
std::optional<Line> line_of(std::span<const double> signal, double period, const DecaySearch& search) {
  const auto length = static_cast<std::size_t>(piece / period);
  if (length < 16 || signal.size() < 10 * length) return {};
  const std::size_t step = std::max(length / 2, signal.size() / pieces_most);
  std::vector<double> times, frequencies, slopes, begins, faded(length);
  for (std::size_t at = 0; at + length <= signal.size(); at += step) {
    for (std::size_t k = 0; k < length; ++k) {
      const double x = static_cast<double>(k) / static_cast<double>(length);
      faded[k] = signal[at + k] * (0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * x));
    }
    const PowerSpectrum spectrum = power_spectrum(faded, period);
    const auto low = static_cast<std::ptrdiff_t>(search.frequency_min / spectrum.step);
    const auto high = static_cast<std::ptrdiff_t>(search.frequency_max / spectrum.step);
    const auto first = spectrum.power.begin() + low;
    const auto last = spectrum.power.begin() + std::min(high, std::ssize(spectrum.power));
    if (last - first < 3) return {};
    times.push_back(period * (static_cast<double>(at) + 0.5 * static_cast<double>(length)));
    frequencies.push_back(spectrum.step * static_cast<double>(std::max_element(first, last) - spectrum.power.begin()));
  }
  for (std::size_t i = 0; i < times.size(); ++i) {
    for (std::size_t j = i + times.size() / 10 + 1; j < times.size(); ++j)
      slopes.push_back((frequencies[j] - frequencies[i]) / (times[j] - times[i]));
  }
  Line line{median(slopes), 0.0};
  for (std::size_t i = 0; i < times.size(); ++i) begins.push_back(frequencies[i] - line.rate * times[i]);
  line.begin = median(begins);
  const auto near = std::ranges::count_if(begins, [&](double b) { return std::abs(b - line.begin) <= apart; });
  const double swept = std::abs(line.rate) * period * static_cast<double>(signal.size());
  if (static_cast<double>(near) < on_line * static_cast<double>(begins.size()) || swept < 10.0 * apart) return {};
  return line;
}

/// From 0 at `from` to 1 at `to`.
double rising(double f, double from, double to) {
  return 0.5 - 0.5 * std::cos(std::numbers::pi * std::clamp((f - from) / (to - from), 0.0, 1.0));
}

}  // namespace

std::optional<SweepAsJolt> sweep_as_jolt(std::span<const double> signal, double period, const DecaySearch& search) {
  const std::optional<Line> line = line_of(signal, period, search);
  if (!line) return {};
  const double ends = line->begin + line->rate * period * static_cast<double>(signal.size());
  const double low = std::max(search.frequency_min, std::min(line->begin, ends));
  const double high = std::min(search.frequency_max, std::max(line->begin, ends));
  SweepAsJolt jolt{.rate = line->rate, .frequency_low = 1.5 * low, .frequency_high = 0.8 * high, .signal = {}};
  if (jolt.frequency_high < 1.5 * jolt.frequency_low) return {};
  std::size_t size = 2;
  while (size < 2 * signal.size()) size *= 2;
  std::vector<double> padded(signal.begin(), signal.end());
  padded.resize(size, 0.0);
  std::vector<std::complex<double>> spectrum, moved;
  Eigen::FFT<double> fft;
  fft.fwd(spectrum, padded);
  const double step = 1.0 / (period * static_cast<double>(size));
  std::size_t count = size / 2;
  while (count > 2 && step * static_cast<double>(count / 2) >= 1.05 * high) count /= 2;
  std::vector<std::complex<double>> both(2 * count, 0.0);
  for (std::size_t i = 1; i < count; ++i) {
    const double f = step * static_cast<double>(i);
    const double kept = rising(f, low, jolt.frequency_low) * rising(-f, -high, -jolt.frequency_high);
    const double swept = f - line->begin;
    const double phase = std::numbers::pi * (swept * swept / line->rate - 2.0 * f * before);
    both[i] = kept * spectrum[i] * std::polar(1.0, std::fmod(phase, 2.0 * std::numbers::pi));
    both[2 * count - i] = std::conj(both[i]);
  }
  fft.inv(moved, both);
  jolt.period = 0.5 / (step * static_cast<double>(count));
  // The jolt is as short as the band in which the sweep fades out allows.
  jolt.begin = static_cast<std::size_t>((before + 1.0 / (high - jolt.frequency_high)) / jolt.period);
  const auto samples = static_cast<std::size_t>((before + behind) / jolt.period);
  for (std::size_t k = 0; k < std::min(samples, moved.size()); ++k) jolt.signal.push_back(moved[k].real());
  return jolt;
}

}  // namespace accdec
