#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <span>
#include <stdexcept>

#include <fmt/format.h>

#include <accdec/design/find_modes.hpp>
#include <accdec/design/free_decay.hpp>
#include <accdec/design/lag_modes.hpp>
#include <accdec/design/noise_modes.hpp>
#include <accdec/design/sweep.hpp>

namespace accdec {
namespace {

constexpr int parts = 4;              // of a log that are compared
constexpr double damping_most = 0.4;  // more is no peak that a filter should avoid
constexpr double slow_log = 0.01;     // s: of a sensor, whose time was likely in other units

/// A mode, and its power.
struct Weighed {
  FoundMode mode;
  double energy = 0.0;
};

/// Whether powers beside each other differ as those of noise do: the logarithms of two by 2 ln 2 in the mean. Those of
/// a sweep are alike. Only powers that are above others count.
bool is_random(const PowerSpectrum& spectrum, double seconds, const FindModesOptions& options) {
  const auto apart = static_cast<std::size_t>(std::max(1.0, std::ceil(1.0 / (seconds * spectrum.step))));
  const auto begin = static_cast<std::size_t>(options.frequency_min / spectrum.step);
  const auto end = std::min(spectrum.power.size(), static_cast<std::size_t>(options.frequency_max / spectrum.step)) -
                   std::min(apart, begin);
  std::vector<double> sorted(spectrum.power.begin() + static_cast<std::ptrdiff_t>(begin),
                             spectrum.power.begin() + static_cast<std::ptrdiff_t>(end));
  std::sort(sorted.begin(), sorted.end());
  const double least = sorted[sorted.size() * 3 / 4];
  double sum = 0.0;
  int count = 0;
  for (std::size_t k = begin; k + apart < end; ++k) {
    if (!(spectrum.power[k] > least && spectrum.power[k + apart] > 0.0)) continue;
    sum += std::abs(std::log(spectrum.power[k] / spectrum.power[k + apart])), ++count;
  }
  return sum > std::numbers::ln2 * count;
}

std::vector<Weighed> weighed(const std::vector<DecayMode>& modes, double whole, std::size_t most,
                             Excitation excitation) {
  std::vector<Weighed> found;
  for (const DecayMode& m : modes) {
    if (found.size() == most) break;
    FoundMode mode{.axis = {},
                   .frequency = m.frequency,
                   .damping = m.damping,
                   .frequency_error = m.error.frequency,
                   .damping_error = m.error.damping,
                   .excitation = excitation};
    mode.damping_low = mode.damping_high = m.damping, mode.share = std::min(1.0, m.energy / whole);
    if (!m.goes_on) mode.doubt = "a period behind the jolts, nothing is left of it; log harder jolts";
    found.push_back({mode, m.energy});
  }
  return found;
}

/// The modes of free vibrations behind jolts; none if the signal is no such.
std::vector<Weighed> modes_behind_jolts(std::span<const double> signal, double period,
                                        const FindModesOptions& options) {
  const DecaySearch search{options.frequency_min, options.frequency_max, damping_most, options.most};
  const FreeDecay decay = free_decay(signal, period, search);
  std::vector<Weighed> found = weighed(decay.modes, decay.energy, options.most, Excitation::jolts);
  for (Weighed& w : found) w.mode.jolts = decay.jolts, w.mode.overlaps = decay.overlaps;
  return found;
}

/// The modes of a sweep; empty if the signal is no sweep at a constant rate.
std::vector<Weighed> modes_of_sweep(std::span<const double> signal, double period, const FindModesOptions& options) {
  const DecaySearch search{options.frequency_min, options.frequency_max, damping_most, options.most};
  const std::optional<SweepAsJolt> jolt = sweep_as_jolt(signal, period, search);
  if (!jolt) return {};
  DecaySearch shown = search;
  shown.frequency_min = jolt->frequency_low, shown.frequency_max = jolt->frequency_high;
  const FreeDecay decay = decay_behind(jolt->signal, jolt->period, jolt->begin, search, shown);
  std::vector<Weighed> found = weighed(decay.modes, decay.energy, options.most, Excitation::sweep);
  for (Weighed& w : found) w.mode.sweep = {jolt->rate, jolt->frequency_low, jolt->frequency_high};
  return found;
}

/// The modes of a signal that is neither a sweep nor free vibrations behind jolts.
std::vector<Weighed> modes_of(std::span<const double> signal, double period, const FindModesOptions& options) {
  const PowerSpectrum spectrum = power_spectrum(signal, period);
  const double seconds = period * static_cast<double>(signal.size());
  const DecaySearch search{options.frequency_min, options.frequency_max, damping_most, options.most};
  if (is_random(spectrum, seconds, options))
    return weighed(noise_modes(spectrum, seconds, search), 1.0, options.most, Excitation::noise);
  std::vector<Weighed> found = weighed(lag_modes(spectrum, seconds, search), 1.0, options.most, Excitation::other);
  for (Weighed& w : found)
    w.mode.doubt = "its errors are not derived for such a log; log jolts, noise, or a sweep at a constant rate";
  return found;
}

/// Compares with parts of the log, which may have been taken at other places of the machine. A part in which the mode
/// was hardly excited says nothing.
FoundMode spread_over_parts(const Weighed& whole, const std::vector<std::vector<Weighed>>& others) {
  constexpr double near = 0.15, enough = 0.3 / parts;
  FoundMode mode = whole.mode;
  for (const std::vector<Weighed>& part : others) {
    const auto off = [&](const Weighed& other) { return std::abs(other.mode.frequency / mode.frequency - 1.0); };
    const auto closest =
        std::min_element(part.begin(), part.end(), [&](const Weighed& a, const Weighed& b) { return off(a) < off(b); });
    if (closest == part.end() || off(*closest) > near || closest->energy < enough * whole.energy) continue;
    ++mode.compared;
    mode.spread = std::max(mode.spread, off(*closest));
    mode.damping_low = std::min(mode.damping_low, closest->mode.damping);
    mode.damping_high = std::max(mode.damping_high, closest->mode.damping);
  }
  return mode;
}

constexpr double errors_of_most = 2.6;  // standard errors that hold 99 of 100

/// Whether the errors are larger than what is promised of a mode.
bool vague(const FoundMode& mode) {
  return errors_of_most * mode.frequency_error > promised_frequency ||
         errors_of_most * mode.damping_error > promised_damping;
}

/// Whether jolts were found in noise: most of them come while it still rings, and no mode between them is certain.
bool jolts_of_noise(const std::vector<Weighed>& found) {
  const auto in_noise = [](const Weighed& w) { return vague(w.mode) && 2 * w.mode.overlaps > w.mode.jolts; };
  return !found.empty() && std::ranges::all_of(found, in_noise);
}

/// Says which modes are uncertain. Two beside each other that the log does not tell apart become one.
std::vector<FoundMode> with_doubts(std::vector<FoundMode> modes) {
  std::vector<FoundMode> kept;
  for (FoundMode& mode : modes) {
    const char* instead = mode.jolts > 0 ? "log more jolts, or harder ones" : "log for longer, or jolt the machine";
    const auto same = std::ranges::find_if(kept, [&](const FoundMode& k) {
      const double apart = std::abs(k.frequency / mode.frequency - 1.0);
      return apart < errors_of_most * std::hypot(k.frequency_error, mode.frequency_error) ||
             (apart < k.damping + mode.damping && vague(k) && vague(mode));
    });
    if (same != kept.end()) {
      same->doubt = fmt::format("two vibrations of {:.4g} and {:.4g} Hz that this log does not tell apart; {}",
                                same->frequency, mode.frequency, instead);
      continue;
    }
    if (mode.certain() && vague(mode)) mode.doubt = fmt::format("its errors are too large; {}", instead);
    kept.push_back(std::move(mode));
  }
  return kept;
}

/// Whether a signal changes by no more than its rounding, which has a spectrum, too.
bool stands_still(std::span<const double> signal) {
  constexpr double rounding = 1e-9;
  const auto [low, high] = std::minmax_element(signal.begin(), signal.end());
  return *high - *low <= rounding * std::max(std::abs(*low), std::abs(*high));
}

}  // namespace

std::vector<FoundMode> find_modes(const VibrationLog& log, const FindModesOptions& options) {
  if (options.frequency_min >= options.frequency_max)
    throw std::invalid_argument(
        fmt::format("the band from {:.4g} to {:.4g} Hz is reversed; allowed is a lowest frequency below the highest",
                    options.frequency_min, options.frequency_max));
  FindModesOptions used = options;
  used.frequency_max = std::min(options.frequency_max, 0.3 / log.period);
  if (!(used.frequency_min > 0.0 && used.frequency_max > 2.0 * used.frequency_min)) {
    throw std::invalid_argument(fmt::format(
        "modes from {:.4g} to {:.4g} Hz cannot be told apart at {:.4g} samples a second; allowed is a band "
        "of at least an octave, up to 0.3 of the sample rate{}",
        used.frequency_min, used.frequency_max, 1.0 / log.period,
        log.period > slow_log ? ". A column t counts seconds; columns of ms and us are t_ms and t_us" : ""));
  }
  const double seconds = log.period * static_cast<double>(log.samples()), needed = 10.0 / used.frequency_min;
  if (seconds < needed) {
    throw std::invalid_argument(
        fmt::format("the log lasts {:.4g} s{}; modes from {:.4g} Hz on need at least {:.4g} s", seconds,
                    log.last_line > 0 ? fmt::format(" up to line {}", log.last_line) : "", used.frequency_min, needed));
  }
  std::vector<FoundMode> all;
  for (std::size_t a = 0; a < log.axes.size(); ++a) {
    const std::span<const double> signal(log.acceleration[a]);
    if (stands_still(signal)) continue;
    std::vector<std::vector<Weighed>> others;
    std::vector<Weighed> all_of_axis = modes_of_sweep(signal, log.period, used);
    const bool swept = !all_of_axis.empty();  // each part has other frequencies
    if (!swept) all_of_axis = modes_behind_jolts(signal, log.period, used);
    if (!swept && jolts_of_noise(all_of_axis)) {
      const std::vector<Weighed> noise = modes_of(signal, log.period, used);
      if (!noise.empty() && noise.front().mode.excitation == Excitation::noise) all_of_axis.clear();
    }
    const auto modes_by = all_of_axis.empty() ? modes_of : modes_behind_jolts;
    for (std::size_t p = 0; p < parts && seconds >= parts * needed && !swept; ++p)
      others.push_back(modes_by(signal.subspan(p * signal.size() / parts, signal.size() / parts), log.period, used));
    if (all_of_axis.empty()) all_of_axis = modes_of(signal, log.period, used);
    std::vector<FoundMode> of_axis;
    for (const Weighed& found : all_of_axis) {
      of_axis.push_back(spread_over_parts(found, others));
      of_axis.back().axis = log.axes[a];
    }
    for (FoundMode& mode : with_doubts(std::move(of_axis))) all.push_back(std::move(mode));
  }
  return all;
}

}  // namespace accdec
