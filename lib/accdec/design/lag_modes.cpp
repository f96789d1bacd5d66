#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>

#include <accdec/design/lag_modes.hpp>
#include <accdec/design/significance.hpp>

namespace accdec {
namespace {

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

/// A mode that may be one.
struct Candidate {
  DecayMode mode;
  bool sure = false;  ///< model orders agree

  /// Weak vibrations count if they are sure: noise gives every model order another damping.
  bool counts(double of_lags) const { return of_lags >= (sure ? share_least : share_large); }
};

/// Tells peaks of a spectrum from noise. Powers of white noise are independent and exponentially distributed, as many
/// for each Hz as the log has seconds.
class Peaks {
 public:
  Peaks(const PowerSpectrum& spectrum, double seconds, const DecaySearch& search)
      : spectrum_(spectrum), seconds_(seconds), cells_(seconds * (search.frequency_max - search.frequency_min)) {}

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

}  // namespace

std::vector<DecayMode> lag_modes(const PowerSpectrum& spectrum, double seconds, const DecaySearch& search) {
  const double longest = std::min(2.0, 0.2 * seconds);
  const Autocorrelation lags =
      cut(autocorrelation(spectrum, search.frequency_min, search.frequency_max, longest), search.frequency_min);
  const Realisation realisation(lags);
  std::vector<Group> groups;
  int tried = 0;
  for (int pairs = 1; pairs <= orders; ++pairs) {
    const std::vector<Pole> poles = realisation.poles(pairs);
    tried += poles.empty() ? 0 : 1;
    for (const Pole& pole : poles) {
      if (pole.damping > search.damping_max || pole.frequency < search.frequency_min ||
          pole.frequency > search.frequency_max)
        continue;
      const auto near = std::find_if(groups.begin(), groups.end(),
                                     [&](const Group& g) { return g.near(pole.frequency) && g.last != pairs; });
      Group& group = near == groups.end() ? groups.emplace_back() : *near;
      group.frequencies.push_back(pole.frequency), group.dampings.push_back(pole.damping), group.last = pairs;
    }
  }
  std::vector<Candidate> found;
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
    const DecayError error{half_spread(group.frequencies), half_spread(group.dampings), 1.0};
    found.push_back({{f, z, 0.0, error}, group.sure(tried)});
  }
  if (found.empty()) return {};
  const std::vector<Part> of = parts_of(lags, stable);
  const double all = std::max(lags.values[0], 1e-300);
  double squares = 0.0;
  for (const double value : lags.values) squares += value * value;
  const Peaks peaks(spectrum, seconds, search);
  std::vector<DecayMode> modes;
  for (std::size_t i = 0; i < found.size(); ++i) {
    found[i].mode.energy = of[i].power / all;
    if (found[i].counts(of[i].energy / squares) && peaks.stands_out(found[i].mode.frequency, found[i].mode.damping))
      modes.push_back(found[i].mode);
  }
  std::ranges::sort(modes, std::ranges::greater{}, &DecayMode::energy);
  return modes;
}

}  // namespace accdec
