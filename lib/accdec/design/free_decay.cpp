#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include <Eigen/Cholesky>
#include <Eigen/Dense>

#include <accdec/design/free_decay.hpp>
#include <accdec/design/power_spectrum.hpp>
#include <accdec/design/significance.hpp>

namespace accdec {
namespace {

constexpr double rises = 2.5;         // energy of a period behind a jolt, over that before it
constexpr double loud = 0.02;         // of the largest energy of a period: quieter jolts are not used
constexpr double explained = 0.5;     // of the energy of the stretches, where only noise is left
constexpr double all_but_all = 0.98;  // the same, where something else is left
constexpr double used_least = 0.5;    // of the energy of the signal
constexpr double least_fitted = 0.2;  // of the energy of the signal, where not all stretches are fitted
constexpr double first_half = 0.6;    // of the energy of stretches that die away
constexpr double least_part = 2e-4;   // of the energy of the stretches
constexpr double by_chance = 1e-3;    // of an axis of a log of noise
constexpr double still_rings = 0.05;  // of the energy behind the last jolt
constexpr double damping_least = 1e-5;

struct Decay {
  double frequency, damping;
};

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

/// Samples at which jolts begin: the energy of the period behind is much larger than that of the period before.
std::vector<std::size_t> jolts_of(const std::vector<double>& signal, std::size_t window) {
  std::vector<double> sums(signal.size() + 1, 0.0);
  for (std::size_t k = 0; k < signal.size(); ++k) sums[k + 1] = sums[k] + signal[k] * signal[k];
  const auto behind = [&](std::size_t k) { return sums[std::min(k + window, signal.size())] - sums[k]; };
  const auto before = [&](std::size_t k) { return sums[k] - sums[k - std::min(k, window)]; };
  double largest = 0.0;
  std::vector<double> energies;
  for (std::size_t k = 0; k + window < signal.size(); k += window) energies.push_back(behind(k));
  for (const double e : energies) largest = std::max(largest, e);
  std::vector<std::size_t> found;
  for (std::size_t k = 0; k + window < signal.size(); ++k) {
    const double rise = behind(k) - before(k);
    if (behind(k) < rises * before(k) || behind(k) < loud * largest) continue;
    if (!found.empty() && k - found.back() <= window) {
      if (rise > behind(found.back()) - before(found.back())) found.back() = k;
    } else {
      found.push_back(k);
    }
  }
  return found;
}

struct Stretch {
  std::size_t begin, end;
};

/// Fits stretches of a signal by poles that all of them share.
class DecayFit {
 public:
  DecayFit(const std::vector<double>& signal, std::vector<Stretch> stretches, double period)
      : signal_(signal), stretches_(std::move(stretches)), period_(period) {
    for (const Stretch& s : stretches_) samples_ += s.end - s.begin;
  }

  std::size_t samples() const { return samples_; }
  std::size_t stretches() const { return stretches_.size(); }
  std::vector<std::vector<double>> in_stretches(const Eigen::VectorXd& all) const {
    std::vector<std::vector<double>> parts;
    const double* at = all.data();
    for (const Stretch& s : stretches_) parts.emplace_back(at, at + (s.end - s.begin)), at += s.end - s.begin;
    return parts;
  }

  /// The signal without the parts of the poles. @param parts  the energy of each pole's part, if asked for
  Eigen::VectorXd rest(const std::vector<Decay>& poles, std::vector<double>* parts = nullptr) const {
    Eigen::VectorXd all(static_cast<Eigen::Index>(samples_));
    if (parts) parts->assign(poles.size(), 0.0);
    Eigen::Index at = 0;
    for (const Stretch& s : stretches_) {
      const auto rows = static_cast<Eigen::Index>(s.end - s.begin);
      const Eigen::MatrixXd basis = waves(poles, rows);
      const Eigen::Map<const Eigen::VectorXd> values(signal_.data() + s.begin, rows);
      Eigen::MatrixXd gram = basis.transpose() * basis;
      gram.diagonal() *= 1.0 + 1e-12;
      const Eigen::VectorXd weights = gram.ldlt().solve(basis.transpose() * values);
      all.segment(at, rows) = values - basis * weights;
      for (std::size_t p = 0; parts && p < poles.size(); ++p) {
        const auto column = 1 + 2 * static_cast<Eigen::Index>(p);
        (*parts)[p] += (basis.middleCols(column, 2) * weights.segment(column, 2)).squaredNorm();
      }
      at += rows;
    }
    return all;
  }

  /// Gauss-Newton with Levenberg's damping in the logarithms of frequencies and damping ratios.
  double improve(std::vector<Decay>& poles, const DecaySearch& search) const {
    constexpr int rounds = 15;
    const auto size = static_cast<Eigen::Index>(2 * poles.size());
    Eigen::VectorXd now = rest(poles);
    double sum = now.squaredNorm(), damp = 1e-3;
    for (int round = 0; round < rounds && sum > 0.0; ++round) {
      Eigen::MatrixXd slopes(now.size(), size);
      for (Eigen::Index i = 0; i < size; ++i) {
        Eigen::VectorXd step = Eigen::VectorXd::Zero(size);
        step[i] = i % 2 == 0 ? 1e-5 : 1e-3;
        slopes.col(i) = (rest(moved(poles, step, search)) - now) / step[i];
      }
      const Eigen::MatrixXd gram = slopes.transpose() * slopes;
      const Eigen::VectorXd down = slopes.transpose() * now;
      bool better = false;
      for (int attempt = 0; attempt < 8 && !better; ++attempt, damp *= 8.0) {
        Eigen::MatrixXd damped = gram;
        damped.diagonal() *= 1.0 + damp;
        const Eigen::VectorXd step = (-damped.ldlt().solve(down)).cwiseMax(-0.5).cwiseMin(0.5);
        const std::vector<Decay> next = moved(poles, step, search);
        const Eigen::VectorXd after = rest(next);
        const double reached = after.squaredNorm();
        if (!(reached < sum)) continue;
        better = true;
        const bool done = sum - reached < 1e-7 * sum;
        poles = next, now = after, sum = reached, damp /= 64.0;
        if (done) return sum;
      }
      if (!better) break;
    }
    return sum;
  }

 private:
  static std::vector<Decay> moved(std::vector<Decay> poles, const Eigen::VectorXd& step, const DecaySearch& search) {
    for (std::size_t p = 0; p < poles.size(); ++p) {
      const auto i = 2 * static_cast<Eigen::Index>(p);
      poles[p].frequency *= std::exp(step[i]);
      poles[p].damping = std::clamp(poles[p].damping * std::exp(step[i + 1]), damping_least, 2.0 * search.damping_max);
      poles[p].damping = std::min(poles[p].damping, 0.9);
    }
    return poles;
  }

  /// A constant, and for every pole the damped cosine and sine.
  Eigen::MatrixXd waves(const std::vector<Decay>& poles, Eigen::Index rows) const {
    Eigen::MatrixXd basis(rows, 1 + 2 * static_cast<Eigen::Index>(poles.size()));
    basis.col(0).setOnes();
    Eigen::Index column = 1;
    for (const Decay& pole : poles) {
      const double w = 2.0 * std::numbers::pi * pole.frequency * period_;
      const double turn = w * std::sqrt(1.0 - pole.damping * pole.damping), fall = std::exp(-pole.damping * w);
      const double c = fall * std::cos(turn), s = fall * std::sin(turn);
      double x = 1.0, y = 0.0;
      for (Eigen::Index k = 0; k < rows; ++k) {
        basis(k, column) = x, basis(k, column + 1) = y;
        const double before = x;
        x = c * x - s * y, y = s * before + c * y;
        if (std::abs(x) + std::abs(y) < 1e-30) x = y = 0.0;
      }
      column += 2;
    }
    return basis;
  }

  const std::vector<double>& signal_;
  std::vector<Stretch> stretches_;
  double period_;
  std::size_t samples_ = 0;
};

struct Fitted {
  std::vector<Decay> poles;
  bool white = false;  ///< whether nothing but noise is left
};

/// Adds modes as long as each is more than what noise would give.
Fitted fitted(const DecayFit& fit, double period, const DecaySearch& search) {
  std::vector<Decay> poles;
  Eigen::VectorXd rest = fit.rest(poles);
  const double whole = rest.squaredNorm(), seconds = static_cast<double>(fit.samples()) * period;
  // Frequencies that can be told apart, with five damping ratios each.
  const double trials = 5.0 * (1.0 + seconds * (search.frequency_max - search.frequency_min));
  for (std::size_t mode = 0; mode < search.most + 2; ++mode) {
    const double before = rest.squaredNorm();
    if (!(before > 1e-7 * whole)) return {poles, true};
    std::vector<Decay> best = poles;
    double least = before;
    const double start = loudest(fit.in_stretches(rest), period, search);
    best.push_back({start, 0.01});
    for (const double damping : {0.003, 0.01, 0.03, 0.1, 0.3}) {
      std::vector<Decay> next = poles;
      next.push_back({start, damping});
      const double sum = fit.rest(next).squaredNorm();
      if (sum < least) least = sum, best = next;
    }
    least = fit.improve(best, search);
    const double free = static_cast<double>(fit.samples()) - 3.0 * static_cast<double>(fit.stretches());
    const double gain = (before - least) / (least / std::max(1.0, free));
    const bool real = gamma_tail(static_cast<int>(fit.stretches()) + 1, 0.5 * gain) * trials < by_chance;
    if (!real || before - least < least_part * whole) return {poles, true};
    if (mode == 0 && before - least < 0.2 * whole) return {};
    poles = best, rest = fit.rest(poles);
  }
  return {poles, false};
}

/// Leaves out the ends of stretches that are as quiet as the quietest parts of the signal. If there are more samples
/// than are fitted in a second, the quietest stretches are left out, too.
void shorten(std::vector<Stretch>& stretches, const std::vector<double>& values, std::size_t window) {
  constexpr std::size_t most = 16'000;
  const auto energy = [&](std::size_t from) {
    double sum = 0.0;
    for (std::size_t k = from; k < std::min(from + window, values.size()); ++k) sum += values[k] * values[k];
    return sum;
  };
  std::vector<double> energies;
  for (std::size_t k = 0; k + window < values.size(); k += window) energies.push_back(energy(k));
  std::ranges::sort(energies);
  const double quiet = 2.0 * energies[energies.size() / 20];
  std::size_t all = 0;
  for (Stretch& s : stretches) {
    std::size_t k = s.begin + 4 * window;
    while (k + window < s.end && energy(k) > quiet) k += window;
    s.end = std::min(s.end, k + (k - s.begin) / 4);
    all += s.end - s.begin;
  }
  const auto louder = [&](const Stretch& a, const Stretch& b) { return energy(a.begin) > energy(b.begin); };
  std::ranges::stable_sort(stretches, louder);
  for (; all > most && stretches.size() > 1; stretches.pop_back()) all -= stretches.back().end - stretches.back().begin;
  stretches.front().end = std::min(stretches.front().end, stretches.front().begin + most);
}

/// Whether the first halves of stretches have most of the energy, which is at least that.
bool dies_away(const std::vector<Stretch>& stretches, const std::vector<double>& values, double least) {
  double first = 0.0, whole = 0.0;
  for (const Stretch& s : stretches) {
    for (std::size_t k = s.begin; k < s.end; ++k) {
      whole += values[k] * values[k];
      if (2 * k < s.begin + s.end) first += values[k] * values[k];
    }
  }
  return whole >= least && first >= first_half * whole;
}

}  // namespace

FreeDecay free_decay(std::span<const double> signal, double period, const DecaySearch& search) {
  const auto factor = static_cast<std::size_t>(std::max(1.0, std::floor(0.2 / (search.frequency_max * period))));
  const std::vector<double> values = averaged(signal, factor);
  const double step = period * static_cast<double>(factor);
  FreeDecay result;
  const auto window = static_cast<std::size_t>(1.0 / (loudest({&values, 1}, step, search) * step));
  if (window < 4 || values.size() < 20 * window) return result;
  const std::vector<std::size_t> jolts = jolts_of(values, window);
  std::vector<Stretch> stretches;
  double all = 0.0;
  for (const double v : values) all += v * v;
  for (std::size_t j = 0; j < jolts.size(); ++j) {
    const std::size_t begin = jolts[j] + std::max<std::size_t>(2, window / 8);
    const std::size_t next = j + 1 < jolts.size() ? jolts[j + 1] : values.size();
    const std::size_t end = j + 1 < jolts.size() ? next - std::min(next, std::max<std::size_t>(2, window / 4)) : next;
    if (end < begin + 2 * window) continue;
    stretches.push_back({begin, end});
    const auto energy = [&](std::size_t from) {
      double sum = 0.0;
      for (std::size_t k = from; k < std::min(from + window, end); ++k) sum += values[k] * values[k];
      return sum;
    };
    if (j + 1 < jolts.size() && energy(end - window) > still_rings * energy(begin)) ++result.overlaps;
  }
  result.jolts = static_cast<int>(jolts.size());
  // Noise rises all the time, and each rise looks like a jolt.
  if (stretches.empty() || (result.overlaps > 10 && 2 * result.overlaps > result.jolts)) return result;
  double within = 0.0;
  for (const Stretch& s : stretches) {
    for (std::size_t k = s.begin; k < s.end; ++k) within += values[k] * values[k];
  }
  if (within < used_least * all) return result;
  shorten(stretches, values, window);
  if (!dies_away(stretches, values, least_fitted * all)) return result;
  const DecayFit fit(values, stretches, step);
  const auto [poles, white] = fitted(fit, step, search);
  const double whole = fit.rest({}).squaredNorm();
  std::vector<double> parts;
  const double left = fit.rest(poles, &parts).squaredNorm();
  if (poles.empty() || left > (1.0 - (white ? explained : all_but_all)) * whole) return result;
  result.energy = whole;
  for (std::size_t p = 0; p < poles.size(); ++p) {
    const bool inside = poles[p].frequency >= search.frequency_min && poles[p].frequency <= search.frequency_max;
    if (inside && poles[p].damping <= search.damping_max && parts[p] >= least_part * whole)
      result.modes.push_back({poles[p].frequency, poles[p].damping, parts[p]});
  }
  std::ranges::sort(result.modes, std::ranges::greater{}, &DecayMode::energy);
  return result;
}

}  // namespace accdec
