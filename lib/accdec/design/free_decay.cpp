#include <algorithm>
#include <cmath>
#include <numeric>

#include <accdec/design/free_decay.hpp>
#include <accdec/design/jolts.hpp>
#include <accdec/design/power_spectrum.hpp>
#include <accdec/design/significance.hpp>

namespace accdec {
namespace {

constexpr double used_least = 0.5;        // of the energy of the signal
constexpr double least_fitted = 0.2;      // of the energy of the signal, where not all stretches are fitted
constexpr double first_half = 0.6;        // of the energy of stretches that die away
constexpr double least_part = 2e-4;       // of the energy of the stretches
constexpr double explained = 0.5;         // of the energy of the stretches
constexpr double by_chance = 1e-3;        // of an axis of a log of noise
constexpr double still_rings = 0.05;      // of the energy behind the last jolt
constexpr double colour_most = 4.0;       // variance of what is left near a mode, over that elsewhere
constexpr double beside = 0.15;           // relative distance of frequencies that one pole may have fitted
constexpr int rounds = 4;                 // in which hidden jolts are left out
constexpr std::size_t windows_least = 8;  // that tell noise from hidden jolts
constexpr std::size_t periods_first = 8, samples_first = 4'000, samples_most = 16'000;

/// Means of `factor` samples. A sum of damped vibrations stays one.
std::vector<double> averaged(std::span<const double> signal, std::size_t factor) {
  const double mean = std::accumulate(signal.begin(), signal.end(), 0.0) / static_cast<double>(signal.size());
  std::vector<double> values(signal.size() / factor);
  for (std::size_t k = 0; k < values.size(); ++k) {
    for (std::size_t i = 0; i < factor; ++i) values[k] += (signal[k * factor + i] - mean) / static_cast<double>(factor);
  }
  return values;
}

/// The frequency of the largest power, summed over signals that belong together.
double loudest(std::span<const std::vector<double>> signals, double period, const DecaySearch& search) {
  std::size_t longest = 0;
  for (const std::vector<double>& signal : signals) longest = std::max(longest, signal.size());
  PowerSpectrum sum;
  for (std::vector<double> signal : signals) {
    signal.resize(longest, 0.0);
    const PowerSpectrum one = power_spectrum(signal, period);
    if (sum.power.empty()) sum = {one.step, std::vector<double>(one.power.size(), 0.0)};
    for (std::size_t k = 0; k < one.power.size(); ++k) sum.power[k] += one.power[k];
  }
  std::size_t best = 0;
  for (std::size_t k = 0; k < sum.power.size(); ++k) {
    const double f = sum.step * static_cast<double>(k);
    if (f < search.frequency_min || f > search.frequency_max) continue;
    if (best == 0 || sum.power[k] > sum.power[best]) best = k;
  }
  return std::max(search.frequency_min, sum.step * static_cast<double>(best));
}

/// The poles with one more, of the frequency that is loudest in what is left. A pole beside it may have fitted two:
/// both are tried to either side of it, too.
std::vector<Decay> one_more(const DecayFit& fit, const std::vector<Decay>& poles, double start,
                            const DecaySearch& search) {
  std::vector<Decay> best = poles;
  best.push_back({start, 0.01});
  double least = fit.rest(best).squaredNorm();
  for (const double damping : {0.003, 0.03, 0.1, 0.3}) {
    std::vector<Decay> next = poles;
    next.push_back({start, damping});
    const double sum = fit.rest(next).squaredNorm();
    if (sum < least) least = sum, best = next;
  }
  least = fit.improve(best, search);
  for (std::size_t p = 0; p < poles.size(); ++p) {
    const double apart = std::abs(start / poles[p].frequency - 1.0);
    if (apart > beside) continue;
    std::vector<Decay> next = poles;
    const double half = std::clamp(apart, 0.01, 0.04);
    next[p] = {poles[p].frequency * (1.0 - half), 0.5 * poles[p].damping};
    next.push_back({poles[p].frequency * (1.0 + half), 0.5 * poles[p].damping});
    const double sum = fit.improve(next, search);
    if (sum < least) least = sum, best = next;
  }
  return best;
}

/// Adds modes as long as each is more than what noise would give.
std::vector<Decay> fitted(const DecayFit& fit, double period, const DecaySearch& search) {
  std::vector<Decay> poles;
  Eigen::VectorXd rest = fit.rest(poles);
  const double whole = rest.squaredNorm(), seconds = static_cast<double>(fit.samples()) * period;
  // Frequencies that can be told apart, with five damping ratios each.
  const double trials = 5.0 * (1.0 + seconds * (search.frequency_max - search.frequency_min));
  for (std::size_t mode = 0; mode < search.most + 2; ++mode) {
    const double before = rest.squaredNorm();
    if (!(before > 1e-7 * whole)) break;
    const double start = loudest(fit.in_stretches(rest), period, search);
    const std::vector<Decay> next = one_more(fit, poles, start, search);
    const Eigen::VectorXd after = fit.rest(next);
    const double least = after.squaredNorm(), unknowns = static_cast<double>(2 * next.size() + 1);
    const double free = static_cast<double>(fit.samples()) - unknowns * static_cast<double>(fit.stretches());
    const double gain = (before - least) / (least / std::max(1.0, free));
    const bool real = gamma_tail(static_cast<int>(fit.stretches()) + 1, 0.5 * gain) * trials < by_chance;
    if (!real || before - least < least_part * whole) break;
    if (mode == 0 && before - least < 0.2 * whole) return {};
    poles = next, rest = after;
  }
  return poles;
}

double energy_of(const std::vector<double>& values, std::size_t begin, std::size_t end) {
  double sum = 0.0;
  for (std::size_t k = begin; k < end; ++k) sum += values[k] * values[k];
  return sum;
}

double energy_of(const std::vector<double>& values, const std::vector<Stretch>& stretches) {
  double sum = 0.0;
  for (const Stretch& s : stretches) sum += energy_of(values, s.begin, s.end);
  return sum;
}

/// Short jolts with the samples beside them that no stretch has. In logs of positions they have most of the energy.
std::vector<Stretch> pushes(const std::vector<Stretch>& jolts, std::size_t samples, std::size_t window) {
  std::vector<Stretch> found;
  for (const Stretch& j : jolts) {
    if (j.end - j.begin > window) continue;
    const std::size_t begin = found.empty() ? 0 : found.back().end;
    found.push_back({std::max(begin, j.begin - std::min(j.begin, window / 4 + 2)),
                     std::min(samples, j.end + std::max<std::size_t>(2, window / 8))});
  }
  std::erase_if(found, [](const Stretch& s) { return s.end <= s.begin; });
  return found;
}

/// Whether the first halves of stretches have most of the energy, which is at least that.
bool dies_away(const std::vector<Stretch>& stretches, const std::vector<double>& values, double least) {
  std::vector<Stretch> halves = stretches;
  for (Stretch& s : halves) s.end = s.begin + (s.end - s.begin) / 2;
  const double whole = energy_of(values, stretches);
  return whole >= least && energy_of(values, halves) >= first_half * whole;
}

/// How many stretches end before the vibration has died away. The last one ends with the log.
int overlaps_of(const std::vector<Stretch>& stretches, const std::vector<double>& values, std::size_t window) {
  int count = 0;
  for (std::size_t j = 0; j + 1 < stretches.size(); ++j) {
    const auto [begin, end] = stretches[j];
    count += energy_of(values, end - window, end) > still_rings * energy_of(values, begin, begin + window) ? 1 : 0;
  }
  return count;
}

/// Jolts by the vibrations that fit between those known, found again with each better fit.
std::vector<Stretch> all_jolts(const std::vector<double>& values, double step, std::size_t window, double loud,
                               const DecaySearch& search) {
  std::vector<Stretch> jolts = jolts_by_rise(values, window);
  if (jolts.empty()) jolts = jolts_by_fit(values, {{loud, 0.01}}, step, 0.2);
  for (const double part : {0.05, 0.01, 0.002}) {
    std::vector<Stretch> stretches = between(jolts, values.size(), window);
    if (stretches.empty()) break;
    const bool first = part > 0.02;
    shorten(stretches, values, window, first ? periods_first * window : 4 * periods_first * window, samples_first);
    const std::vector<Decay> poles = fitted(DecayFit(values, stretches, step), step, search);
    if (poles.empty()) break;
    std::vector<Stretch> next = jolts_by_fit(values, poles, step, part);
    if (next.empty()) break;
    jolts = std::move(next);
  }
  return jolts;
}

/// Windows in which more is left than noise would leave in one log of a thousand: a jolt is hidden there.
std::vector<Stretch> windows_with_jolts(const DecayFit& fit, const std::vector<Decay>& poles, std::size_t window) {
  const std::vector<std::vector<double>> rests = fit.in_stretches(fit.rest(poles));
  std::vector<double> energies;
  for (const std::vector<double>& rest : rests) {
    for (std::size_t k = 0; k + window <= rest.size(); k += window) energies.push_back(energy_of(rest, k, k + window));
  }
  if (energies.size() < windows_least) return {};
  std::vector<double> sorted = energies;
  std::ranges::sort(sorted);
  const double middle = sorted[sorted.size() / 2], range = sorted[3 * sorted.size() / 4] - sorted[sorted.size() / 4];
  // Chi squared with n degrees of freedom has a middle half of 1.349 sqrt(2 n). Coloured noise has fewer than samples.
  const double most = static_cast<double>(window), half = range > 0.0 ? std::pow(1.349 * middle / range, 2) : most;
  const auto degrees = static_cast<int>(std::clamp(half, 1.0, 0.5 * most));
  const auto hidden = [&](double energy) {
    const double chance = gamma_tail(degrees, degrees * energy / std::max(middle, 1e-300));
    return chance * static_cast<double>(energies.size()) < by_chance;
  };
  std::vector<Stretch> found;
  std::size_t next = 0;
  for (std::size_t s = 0; s < rests.size(); ++s) {
    const std::size_t begin = fit.all()[s].begin;
    for (std::size_t k = 0; k + window <= rests[s].size(); k += window)
      if (hidden(energies[next++])) found.push_back({begin + k, begin + k + window});
  }
  return found;
}

/// Jolts and more of them as one list; those with no stretch between them become one.
std::vector<Stretch> merged(std::vector<Stretch> jolts, const std::vector<Stretch>& more, std::size_t window) {
  jolts.insert(jolts.end(), more.begin(), more.end());
  std::ranges::sort(jolts, {}, &Stretch::begin);
  std::vector<Stretch> all;
  for (const Stretch& jolt : jolts) {
    if (all.empty() || jolt.begin > all.back().end + 2 * window) all.push_back(jolt);
    all.back().end = std::max(all.back().end, jolt.end);
  }
  return all;
}

/// Whether a vibration stands out from noise, too, if every stretch begins a period of it later.
bool goes_on(const DecayFit& fit, const std::vector<double>& values, const std::vector<Decay>& poles, std::size_t pole,
             double period) {
  std::vector<Stretch> later = fit.all();
  for (Stretch& s : later) s.begin += static_cast<std::size_t>(std::ceil(1.0 / (poles[pole].frequency * period)));
  const std::size_t unknowns = 2 * poles.size() + 1;
  std::erase_if(later, [&](const Stretch& s) { return s.end < s.begin + 2 * unknowns; });
  if (later.empty()) return false;
  const DecayFit rest(values, later, period);
  std::vector<Decay> others = poles;
  others.erase(others.begin() + static_cast<std::ptrdiff_t>(pole));
  const double least = rest.rest(poles).squaredNorm(), without = rest.rest(others).squaredNorm();
  const double free = static_cast<double>(rest.samples()) - static_cast<double>(unknowns * rest.stretches());
  const double gain = (without - least) / (least / std::max(1.0, free));
  return gamma_tail(static_cast<int>(rest.stretches()), 0.5 * gain) < by_chance;
}

/// The vibrations that were fitted, as modes.
FreeDecay judged(FreeDecay result, const DecayFit& fit, const std::vector<double>& values,
                 const std::vector<Decay>& poles, double step, const DecaySearch& search) {
  const double whole = fit.rest({}).squaredNorm();
  std::vector<double> parts;
  const double left = fit.rest(poles, &parts).squaredNorm();
  if (poles.empty() || left > (1.0 - explained) * whole) return result;
  const std::vector<DecayError> errors = fit.errors(poles, search);
  result.energy = whole;
  for (std::size_t p = 0; p < poles.size(); ++p) {
    const bool inside = poles[p].frequency >= search.frequency_min && poles[p].frequency <= search.frequency_max;
    if (!inside || poles[p].damping > search.damping_max || parts[p] < least_part * whole) continue;
    if (errors[p].colour > colour_most) return {};
    result.modes.push_back(
        {poles[p].frequency, poles[p].damping, parts[p], errors[p], goes_on(fit, values, poles, p, step)});
  }
  std::ranges::sort(result.modes, std::ranges::greater{}, &DecayMode::energy);
  return result;
}

}  // namespace

FreeDecay free_decay(std::span<const double> signal, double period, const DecaySearch& search) {
  const auto factor = static_cast<std::size_t>(std::max(1.0, std::floor(0.2 / (search.frequency_max * period))));
  const std::vector<double> values = averaged(signal, factor);
  const double step = period * static_cast<double>(factor);
  FreeDecay result;
  const double loud = loudest({&values, 1}, step, search);
  const auto window = static_cast<std::size_t>(1.0 / (loud * step));
  if (window < 4 || values.size() < 20 * window) return result;
  std::vector<Stretch> jolts = all_jolts(values, step, window, loud, search), stretches;
  std::vector<Decay> poles;
  for (int round = 0;; ++round) {
    stretches = between(jolts, values.size(), window);
    const double all = energy_of(values, 0, values.size()) - energy_of(values, pushes(jolts, values.size(), window));
    if (stretches.empty() || energy_of(values, stretches) < used_least * all) return result;
    result.jolts = static_cast<int>(jolts.size()), result.overlaps = overlaps_of(stretches, values, window);
    shorten(stretches, values, window, samples_most, samples_most);
    if (stretches.empty() || !dies_away(stretches, values, least_fitted * all)) return result;
    const DecayFit tried(values, stretches, step);
    poles = fitted(tried, step, search);
    if (poles.empty() || round == rounds) break;
    const std::vector<Stretch> hidden = windows_with_jolts(tried, poles, window);
    if (hidden.empty()) break;
    jolts = merged(std::move(jolts), hidden, window);
  }
  return judged(std::move(result), DecayFit(values, stretches, step), values, poles, step, search);
}

FreeDecay decay_behind(const std::vector<double>& values, double period, std::size_t begin, const DecaySearch& search,
                       const DecaySearch& shown) {
  FreeDecay result{.modes = {}, .jolts = 1};
  const double loud = loudest({&values, 1}, period, search);
  const auto window = static_cast<std::size_t>(1.0 / (loud * period));
  std::vector<Stretch> stretches{{begin, values.size()}};
  if (window < 4 || values.size() < begin + 8 * window) return result;
  shorten(stretches, values, window, samples_most, samples_most);
  if (stretches.empty()) return result;
  const DecayFit fit(values, stretches, period);
  return judged(std::move(result), fit, values, fitted(fit, period, search), period, shown);
}

}  // namespace accdec
