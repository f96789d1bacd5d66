#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>
#include <optional>
#include <span>
#include <stdexcept>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <fmt/format.h>

#include <accdec/design/find_modes.hpp>
#include <accdec/design/free_decay.hpp>
#include <accdec/design/noise_modes.hpp>
#include <accdec/design/significance.hpp>

namespace accdec {
namespace {

constexpr int parts = 4;                // of a log that are compared
constexpr double damping_most = 0.4;    // more is no peak that a filter should avoid
constexpr double least_left = 1e-2;     // of the energy of the lags: later ones are noise
constexpr double share_least = 0.002;   // of the energy of the lags of others, as ends of sweeps look like modes
constexpr double share_large = 0.03;    // of the energy of the lags: model orders may disagree
constexpr double false_alarm = 1e-3;    // modes of an axis in white noise
constexpr double agree = 0.1;           // of the damping: the middle half of the model orders
constexpr double same = 0.03;           // relative difference of frequencies of one mode
constexpr int orders = 20;              // pairs of poles at most
constexpr std::size_t size_most = 240;  // of the Hankel matrix

struct Pole {
  double frequency, damping;
  std::complex<double> factor;  // from one lag to the next
};

double middle(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

/// Half of the relative range of the middle half of values.
double half_spread(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t quarter = values.size() / 4;
  return 0.5 * (values[values.size() - 1 - quarter] - values[quarter]) / values[values.size() / 2];
}

/// Poles of sums of damped vibrations that agree with an autocorrelation, by model order.
class Realisation {
 public:
  explicit Realisation(const Autocorrelation& lags) : period_(lags.period) {
    // The first lags hold white noise and what faded out of the band.
    const std::size_t first = 2, size = std::min(size_most, (lags.values.size() - first) / 2);
    const auto n = static_cast<Eigen::Index>(size);
    Eigen::MatrixXd now(n, n);
    next_.resize(n, n);
    for (Eigen::Index i = 0; i < n; ++i) {
      for (Eigen::Index j = 0; j < n; ++j) {
        const std::size_t lag = first + static_cast<std::size_t>(i + j);
        now(i, j) = lags.values[lag], next_(i, j) = lags.values[lag + 1];
      }
    }
    // The matrix is symmetric: singular values are the magnitudes of its eigenvalues.
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> symmetric(now);
    std::vector<Eigen::Index> largest_first(size);
    std::iota(largest_first.begin(), largest_first.end(), Eigen::Index{0});
    const Eigen::VectorXd& values = symmetric.eigenvalues();
    std::stable_sort(largest_first.begin(), largest_first.end(),
                     [&](Eigen::Index a, Eigen::Index b) { return std::abs(values[a]) > std::abs(values[b]); });
    left_.resize(n, n), right_.resize(n, n), values_.resize(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const Eigen::Index from = largest_first[static_cast<std::size_t>(i)];
      values_[i] = std::abs(values[from]);
      left_.col(i) = symmetric.eigenvectors().col(from);
      right_.col(i) = std::copysign(1.0, values[from]) * left_.col(i);
    }
  }

  std::vector<Pole> poles(int pairs) const {
    const Eigen::Index n = 2 * static_cast<Eigen::Index>(pairs);
    if (n > values_.size() || !(values_[n - 1] > 1e-9 * values_[0])) return {};
    const Eigen::VectorXd scale = values_.head(n).cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd shift =
        scale.asDiagonal() * left_.leftCols(n).transpose() * next_ * right_.leftCols(n) * scale.asDiagonal();
    std::vector<Pole> found;
    for (const std::complex<double>& factor : shift.eigenvalues()) {
      if (!(factor.imag() > 0.0) || std::abs(factor) >= 1.0) continue;
      const std::complex<double> rate = std::log(factor) / period_;
      found.push_back({std::abs(rate) / (2.0 * std::numbers::pi), -rate.real() / std::abs(rate), factor});
    }
    return found;
  }

 private:
  double period_;
  Eigen::MatrixXd next_, left_, right_;
  Eigen::VectorXd values_;
};

/// Lags until little is left of the vibrations.
Autocorrelation cut(Autocorrelation lags, double low) {
  const std::size_t part = std::max<std::size_t>(4, static_cast<std::size_t>(1.0 / (low * lags.period)));
  const auto energy = [&](std::size_t from) {
    double sum = 0.0;
    for (std::size_t k = from; k < std::min(from + part, lags.values.size()); ++k)
      sum += lags.values[k] * lags.values[k];
    return sum;
  };
  const double begin = energy(2);
  std::size_t end = 2 + 2 * part;
  while (end + part < lags.values.size() && energy(end) > least_left * begin) end += part;
  lags.values.resize(std::min(lags.values.size(), std::max<std::size_t>(end, 80)));
  return lags;
}

/// A mode, and its power.
struct Weighed {
  FoundMode mode;
  double energy = 0.0;
  bool sure = false;  ///< model orders agree

  double of_lags = 0.0;  ///< its part of the energy of the lags

  /// Weak vibrations count if they are sure: noise gives every model order another damping.
  bool counts() const { return of_lags >= (sure ? share_least : share_large); }
};

/// Tells peaks of a spectrum from noise. Powers of white noise are independent and exponentially distributed, as many
/// for each Hz as the log has seconds.
class Peaks {
 public:
  Peaks(const PowerSpectrum& spectrum, double seconds, const FindModesOptions& options)
      : spectrum_(spectrum), seconds_(seconds), cells_(seconds * (options.frequency_max - options.frequency_min)) {}

  /// Whether the power within the peak's width is more than noise as loud as the flanks would have. The threshold
  /// counts all frequencies and widths: about one log of white noise in 1000 has such a peak.
  bool stands_out(double frequency, double damping) const {
    const double half = std::max(frequency * damping, 1.5 / seconds_);
    const auto [in, counted] = mean(frequency - half, frequency + half);
    const auto [low, of_low] = mean(frequency - 6.0 * half, frequency - 2.5 * half);
    const auto [high, of_high] = mean(frequency + 2.5 * half, frequency + 6.0 * half);
    const double flanks = of_low + of_high;
    if (!(flanks > 0.0)) return true;
    const double noise = (low * of_low + high * of_high) / flanks * (1.0 + 2.0 / std::sqrt(flanks));
    constexpr double widths = 5.0;
    const int count = static_cast<int>(std::lround(counted));
    return gamma_tail(count, count * in / noise) * cells_ * widths < false_alarm;
  }

 private:
  /// Mean power and the number of independent powers.
  std::pair<double, double> mean(double from, double to) const {
    double sum = 0.0;
    int n = 0;
    const auto begin = static_cast<std::size_t>(std::max(0.0, std::ceil(from / spectrum_.step)));
    for (std::size_t k = begin; k < spectrum_.power.size() && spectrum_.step * static_cast<double>(k) <= to; ++k)
      sum += spectrum_.power[k], ++n;
    return {n > 0 ? sum / n : 0.0, n * spectrum_.step * seconds_};
  }

  const PowerSpectrum& spectrum_;
  double seconds_, cells_;
};

/// Poles of several model orders that may be one mode.
struct Group {
  std::vector<double> frequencies, dampings;
  int last = 0;

  bool near(double frequency) const { return std::abs(middle(frequencies) - frequency) < same * frequency; }
  bool sure(int tried) const {
    if (10 * static_cast<int>(dampings.size()) < 7 * tried) return false;
    return 2.0 * half_spread(dampings) <= agree;
  }
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

/// The parts of the first lag and of the energy of the lags.
struct Part {
  double power, energy;
};

/// The part of each pole in the lags, fitted by all poles together.
std::vector<Part> parts_of(const Autocorrelation& lags, const std::vector<Pole>& poles) {
  const auto rows = static_cast<Eigen::Index>(lags.values.size()) - 2, count = static_cast<Eigen::Index>(poles.size());
  Eigen::MatrixXd basis(rows, 2 * count);
  Eigen::VectorXd values(rows);
  for (Eigen::Index k = 0; k < rows; ++k) {
    values[k] = lags.values[static_cast<std::size_t>(k) + 2];
    for (Eigen::Index p = 0; p < count; ++p) {
      const std::complex<double> at = std::pow(poles[static_cast<std::size_t>(p)].factor, static_cast<double>(k));
      basis(k, 2 * p) = at.real(), basis(k, 2 * p + 1) = at.imag();
    }
  }
  const Eigen::VectorXd weights = basis.colPivHouseholderQr().solve(values);
  std::vector<Part> result;
  for (Eigen::Index p = 0; p < count; ++p) {
    const Eigen::VectorXd part = basis.middleCols(2 * p, 2) * weights.segment(2 * p, 2);
    result.push_back({std::abs(part[0]), part.squaredNorm()});
  }
  return result;
}

std::vector<Weighed> weighed(const std::vector<DecayMode>& modes, double whole, std::size_t most) {
  std::vector<Weighed> found;
  for (const DecayMode& m : modes) {
    if (found.size() == most) break;
    FoundMode mode{.axis = {},
                   .frequency = m.frequency,
                   .damping = m.damping,
                   .frequency_error = m.error.frequency,
                   .damping_error = m.error.damping};
    mode.damping_low = mode.damping_high = m.damping, mode.share = std::min(1.0, m.energy / whole);
    found.push_back({mode, m.energy, true, 0.0});
  }
  return found;
}

/// The modes of free vibrations behind jolts; none if the signal is no such.
std::vector<Weighed> modes_behind_jolts(std::span<const double> signal, double period,
                                        const FindModesOptions& options) {
  const DecaySearch search{options.frequency_min, options.frequency_max, damping_most, options.most};
  const FreeDecay decay = free_decay(signal, period, search);
  std::vector<Weighed> found = weighed(decay.modes, decay.energy, options.most);
  for (Weighed& w : found) w.mode.jolts = decay.jolts, w.mode.overlaps = decay.overlaps;
  return found;
}

/// The modes of a signal that most model orders find.
std::vector<Weighed> modes_of(std::span<const double> signal, double period, const FindModesOptions& options) {
  const double longest = std::min(2.0, 0.2 * period * static_cast<double>(signal.size()));
  const PowerSpectrum spectrum = power_spectrum(signal, period);
  const double seconds = period * static_cast<double>(signal.size());
  const bool random = is_random(spectrum, seconds, options);
  if (random) {
    const DecaySearch search{options.frequency_min, options.frequency_max, damping_most, options.most};
    return weighed(noise_modes(spectrum, seconds, search), 1.0, options.most);
  }
  const Autocorrelation lags =
      cut(autocorrelation(spectrum, options.frequency_min, options.frequency_max, longest), options.frequency_min);
  const Realisation realisation(lags);
  std::vector<Group> groups;
  int tried = 0;
  for (int pairs = 1; pairs <= orders; ++pairs) {
    const std::vector<Pole> poles = realisation.poles(pairs);
    tried += poles.empty() ? 0 : 1;
    for (const Pole& pole : poles) {
      if (pole.damping > damping_most || pole.frequency < options.frequency_min ||
          pole.frequency > options.frequency_max)
        continue;
      const auto near = std::find_if(groups.begin(), groups.end(),
                                     [&](const Group& g) { return g.near(pole.frequency) && g.last != pairs; });
      Group& group = near == groups.end() ? groups.emplace_back() : *near;
      group.frequencies.push_back(pole.frequency), group.dampings.push_back(pole.damping), group.last = pairs;
    }
  }
  std::vector<Weighed> found;
  std::vector<Pole> stable;
  std::stable_sort(groups.begin(), groups.end(),
                   [](const Group& a, const Group& b) { return a.dampings.size() > b.dampings.size(); });
  for (const Group& group : groups) {
    // Some orders show a mode by two poles. Two of the same mode would both get all of its energy.
    const auto shown = [&](const Pole& pole) { return group.near(pole.frequency); };
    if (2 * static_cast<int>(group.dampings.size()) < tried || std::ranges::any_of(stable, shown)) continue;
    const double f = middle(group.frequencies), z = middle(group.dampings), w = 2.0 * std::numbers::pi * f;
    const std::complex<double> rate(-z * w, w * std::sqrt(1.0 - z * z));
    stable.push_back({f, z, std::exp(rate * lags.period)});
    FoundMode mode{.axis = {},
                   .frequency = f,
                   .damping = z,
                   .frequency_error = half_spread(group.frequencies),
                   .damping_error = half_spread(group.dampings)};
    mode.damping_low = mode.damping_high = z;
    found.push_back({mode, 0.0, group.sure(tried)});
  }
  if (found.empty()) return found;
  const std::vector<Part> of = parts_of(lags, stable);
  const double all = std::max(lags.values[0], 1e-300);
  double squares = 0.0;
  for (const double value : lags.values) squares += value * value;
  for (std::size_t i = 0; i < found.size(); ++i) {
    found[i].energy = of[i].power, found[i].mode.share = std::min(1.0, of[i].power / all);
    found[i].of_lags = of[i].energy / squares;
  }
  const Peaks peaks(spectrum, seconds, options);
  std::erase_if(found,
                [&](const Weighed& w) { return !w.counts() || !peaks.stands_out(w.mode.frequency, w.mode.damping); });
  std::sort(found.begin(), found.end(), [](const Weighed& a, const Weighed& b) { return a.energy > b.energy; });
  found.resize(std::min(found.size(), options.most));
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

/// Says which modes are uncertain. Two beside each other that the log does not tell apart become one.
std::vector<FoundMode> with_doubts(std::vector<FoundMode> modes) {
  constexpr double sure = 2.6;  // standard errors that hold 99 of 100
  const auto vague = [](const FoundMode& m) {
    return sure * m.frequency_error > promised_frequency || sure * m.damping_error > promised_damping;
  };
  std::vector<FoundMode> kept;
  for (FoundMode& mode : modes) {
    const char* instead = mode.jolts > 0 ? "log more jolts, or harder ones" : "log for longer, or jolt the machine";
    const auto same = std::ranges::find_if(kept, [&](const FoundMode& k) {
      const double apart = std::abs(k.frequency / mode.frequency - 1.0);
      return apart < sure * std::hypot(k.frequency_error, mode.frequency_error) ||
             (apart < k.damping + mode.damping && vague(k) && vague(mode));
    });
    if (same != kept.end()) {
      same->doubt = fmt::format("two vibrations of {:.4g} and {:.4g} Hz that this log does not tell apart; {}",
                                same->frequency, mode.frequency, instead);
      continue;
    }
    if (vague(mode)) mode.doubt = fmt::format("its errors are too large; {}", instead);
    kept.push_back(std::move(mode));
  }
  return kept;
}

}  // namespace

std::vector<FoundMode> find_modes(const VibrationLog& log, const FindModesOptions& options) {
  FindModesOptions used = options;
  used.frequency_max = std::min(options.frequency_max, 0.3 / log.period);
  if (!(used.frequency_min > 0.0 && used.frequency_max > 2.0 * used.frequency_min)) {
    throw std::invalid_argument(
        fmt::format("modes from {:.4g} to {:.4g} Hz cannot be told apart at {:.4g} samples a second; allowed is a band "
                    "of at least an octave, up to 0.3 of the sample rate",
                    used.frequency_min, used.frequency_max, 1.0 / log.period));
  }
  const double seconds = log.period * static_cast<double>(log.samples()), needed = 10.0 / used.frequency_min;
  if (seconds < needed) {
    throw std::invalid_argument(fmt::format("the log lasts {:.4g} s; modes from {:.4g} Hz on need at least {:.4g} s",
                                            seconds, used.frequency_min, needed));
  }
  std::vector<FoundMode> all;
  for (std::size_t a = 0; a < log.axes.size(); ++a) {
    const std::span<const double> signal(log.acceleration[a]);
    std::vector<std::vector<Weighed>> others;
    std::vector<Weighed> all_of_axis = modes_behind_jolts(signal, log.period, used);
    const auto modes_by = all_of_axis.empty() ? modes_of : modes_behind_jolts;
    for (std::size_t p = 0; p < parts && seconds >= parts * needed; ++p)
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
