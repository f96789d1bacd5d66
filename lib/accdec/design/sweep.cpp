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
  double on = 0.0;  // part of the pieces that are
};

double median(std::vector<double> values) {
  const auto middle = values.begin() + std::ssize(values) / 2;
  std::ranges::nth_element(values, middle);
  return *middle;
}

/// The line that most of the frequencies at these times are on.
Line line_through(const std::vector<double>& times, const std::vector<double>& frequencies) {
  std::vector<double> slopes, begins;
  for (std::size_t i = 0; i < times.size(); ++i) {
    for (std::size_t j = i + times.size() / 10 + 1; j < times.size(); ++j)
      slopes.push_back((frequencies[j] - frequencies[i]) / (times[j] - times[i]));
  }
  Line line{median(slopes), 0.0};
  for (std::size_t i = 0; i < times.size(); ++i) begins.push_back(frequencies[i] - line.rate * times[i]);
  line.begin = median(begins);
  const auto near = std::ranges::count_if(begins, [&](double b) { return std::abs(b - line.begin) <= apart; });
  line.on = static_cast<double>(near) / static_cast<double>(begins.size());
  return line;
}

/// The line through the loudest frequencies of pieces of the log, if it is one. A mode that rings on for long is louder
/// than the sweep that has passed it. So each frequency is also compared with itself alone: it is loudest as it is
/// passed.
std::optional<Line> line_of(std::span<const double> signal, double period, const DecaySearch& search) {
  const auto length = static_cast<std::size_t>(piece / period);
  if (length < 16 || signal.size() < 10 * length) return {};
  const std::size_t step = std::max(length / 2, signal.size() / pieces_most);
  std::vector<double> times, faded(length), largest;
  std::vector<std::vector<double>> powers;  // of every piece, by frequency
  std::size_t low = 0;
  double spacing = 0.0;
  for (std::size_t at = 0; at + length <= signal.size(); at += step) {
    for (std::size_t k = 0; k < length; ++k) {
      const double x = static_cast<double>(k) / static_cast<double>(length);
      faded[k] = signal[at + k] * (0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * x));
    }
    const PowerSpectrum spectrum = power_spectrum(faded, period);
    spacing = spectrum.step, low = static_cast<std::size_t>(search.frequency_min / spacing);
    const auto high = std::min(static_cast<std::size_t>(search.frequency_max / spacing), spectrum.power.size());
    if (high < low + 3) return {};
    powers.emplace_back(spectrum.power.begin() + static_cast<std::ptrdiff_t>(low),
                        spectrum.power.begin() + static_cast<std::ptrdiff_t>(high));
    largest.resize(powers.back().size(), 1e-300);
    for (std::size_t k = 0; k < largest.size(); ++k) largest[k] = std::max(largest[k], powers.back()[k]);
    times.push_back(period * (static_cast<double>(at) + 0.5 * static_cast<double>(length)));
  }
  Line best{0.0, 0.0};
  for (const bool alone : {false, true}) {
    std::vector<double> frequencies;
    for (std::vector<double>& power : powers) {
      for (std::size_t k = 0; k < power.size() && alone; ++k) power[k] /= largest[k];
      const auto loudest = static_cast<std::size_t>(std::ranges::max_element(power) - power.begin());
      frequencies.push_back(spacing * static_cast<double>(low + loudest));
    }
    const Line line = line_through(times, frequencies);
    const double swept = std::abs(line.rate) * period * static_cast<double>(signal.size());
    if (swept >= 10.0 * apart && line.on > best.on) best = line;
  }
  return best.on >= on_line ? std::optional(best) : std::nullopt;
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
