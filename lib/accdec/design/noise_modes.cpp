#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Cholesky>
#include <Eigen/Dense>

#include <accdec/design/noise_modes.hpp>
#include <accdec/design/significance.hpp>

namespace accdec {
namespace {

constexpr double by_chance = 1e-3;  // of an axis of a log of noise

/// Powers of a band and the model of them: white noise with a slope, and vibrations. The unknowns are two of the noise
/// and four of each vibration: logarithms of frequency and damping ratio, r and s.
class NoiseFit {
 public:
  NoiseFit(const PowerSpectrum& spectrum, double seconds, const DecaySearch& search)
      : period_(0.5 / spectrum.end()), weight_(std::min(1.0, spectrum.step * seconds)) {
    const auto begin = static_cast<std::size_t>(std::ceil(search.frequency_min / spectrum.step));
    const auto end = std::min(spectrum.power.size(), static_cast<std::size_t>(search.frequency_max / spectrum.step));
    // Means of powers beside each other are as good as these, and fewer.
    const std::size_t group = std::max<std::size_t>(1, (end - std::min(begin, end)) / 3000);
    double sum = 0.0;
    for (std::size_t k = begin; k + group <= end; k += group) {
      double power = 0.0;
      for (std::size_t i = k; i < k + group; ++i) power += spectrum.power[i] / static_cast<double>(group);
      frequencies_.push_back(spectrum.step * (static_cast<double>(k) + 0.5 * static_cast<double>(group - 1)));
      powers_.push_back(power), sum += power;
    }
    weight_ *= static_cast<double>(group);
    mean_ = sum / std::max(1.0, static_cast<double>(powers_.size()));
    if (mean_ > 0.0) std::ranges::for_each(powers_, [&](double& p) { p /= mean_; });
  }

  bool empty() const { return powers_.size() < 20 || !(mean_ > 0.0); }
  const std::vector<double>& frequencies() const { return frequencies_; }
  Eigen::VectorXd noise() const { return Eigen::Vector2d(0.0, 0.0); }

  /// Powers over those of the model; empty if the model has a power that is not positive.
  std::vector<double> ratios(const Eigen::VectorXd& unknowns) const {
    const std::vector<Term> terms = terms_of(unknowns);
    std::vector<double> all(powers_.size());
    for (std::size_t k = 0; k < powers_.size(); ++k) {
      const double p = value(terms, unknowns, k, nullptr);
      if (!(p > 0.0)) return {};
      all[k] = powers_[k] / p;
    }
    return all;
  }

  /// Minus the logarithm of the likelihood.
  double unlikely(const Eigen::VectorXd& unknowns) const {
    const std::vector<Term> terms = terms_of(unknowns);
    double sum = 0.0;
    for (std::size_t k = 0; k < powers_.size(); ++k) {
      const double p = value(terms, unknowns, k, nullptr);
      if (!(p > 1e-12)) return std::numeric_limits<double>::infinity();
      sum += std::log(p) + powers_[k] / p;
    }
    return weight_ * sum;
  }

  /// Fisher's information, and the slope of the likelihood.
  std::pair<Eigen::MatrixXd, Eigen::VectorXd> information(const Eigen::VectorXd& unknowns) const {
    const std::vector<Term> terms = terms_of(unknowns);
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(unknowns.size(), unknowns.size());
    Eigen::VectorXd slope = Eigen::VectorXd::Zero(unknowns.size()), by(unknowns.size());
    for (std::size_t k = 0; k < powers_.size(); ++k) {
      const double p = value(terms, unknowns, k, &by);
      by /= p;
      sum.selfadjointView<Eigen::Lower>().rankUpdate(by, weight_);
      slope += weight_ * (powers_[k] / p - 1.0) * by;
    }
    sum = sum.selfadjointView<Eigen::Lower>();
    return {sum, slope};
  }

  /// Scoring with Levenberg's damping. @return `unlikely` there
  double improve(Eigen::VectorXd& unknowns) const {
    constexpr int rounds = 60;
    double now = unlikely(unknowns), damp = 1e-2;
    for (int round = 0; round < rounds && std::isfinite(now); ++round) {
      const auto [sum, slope] = information(unknowns);
      bool better = false, done = false;
      for (int attempt = 0; attempt < 8 && !better; ++attempt, damp *= 8.0) {
        Eigen::MatrixXd damped = sum;
        damped.diagonal() *= 1.0 + damp;
        Eigen::VectorXd step = damped.ldlt().solve(slope);
        step[0] = std::clamp(step[0], -1.0, 1.0);
        for (Eigen::Index i = 2; i < step.size(); i += 4) {
          step[i] = std::clamp(step[i], -0.1, 0.1), step[i + 1] = std::clamp(step[i + 1], -0.5, 0.5);
          step[i + 2] = std::clamp(step[i + 2], -1.0, 1.0);
        }
        const Eigen::VectorXd next = unknowns + step;
        const double reached = unlikely(next);
        if (!(reached < now)) continue;
        better = true, done = now - reached < 1e-3 && damp < 1.0;
        unknowns = next, now = reached, damp /= 64.0;
      }
      if (!better || done) break;
    }
    return now;
  }

  /// The unknowns with one more vibration, whose power is `part` of that of the model at its peak.
  Eigen::VectorXd with(const Eigen::VectorXd& unknowns, double frequency, double damping, double part) const {
    Eigen::VectorXd more(unknowns.size() + 4);
    more << unknowns, std::log(frequency), std::log(damping), 0.0, 0.0;
    const auto near = std::ranges::lower_bound(frequencies_, frequency);
    const auto k = static_cast<std::size_t>(std::min(near, frequencies_.end() - 1) - frequencies_.begin());
    const double before = value(terms_of(unknowns), unknowns, k, nullptr);
    more[unknowns.size() + 2] =
        std::log(part * before / std::max(1e-300, value(terms_of(more), more, k, nullptr) - before));
    return more;
  }

  /// The sum of powers of a vibration, over that of all powers.
  double part(const Eigen::VectorXd& unknowns, Eigen::Index vibration) const {
    Eigen::VectorXd alone(6);
    alone << -700.0, 0.0, unknowns.segment(2 + 4 * vibration, 4);
    const std::vector<Term> terms = terms_of(alone);
    double sum = 0.0;
    for (std::size_t k = 0; k < powers_.size(); ++k) sum += value(terms, alone, k, nullptr);
    return sum / static_cast<double>(powers_.size());
  }

  double mean() const { return mean_; }
  double weight() const { return weight_; }
  /// Powers in the mean of which one consists; their spread is that much smaller.
  double cells() const { return std::max(1.0, weight_); }

 private:
  /// A vibration's divisor, by powers of the cosine of the angle, and its slopes by the logarithms of frequency and
  /// damping ratio.
  struct Term {
    Eigen::Vector3d below, by_frequency, by_damping;
    double centre, moves;  // cosine at the frequency less 1, and its slope over itself
  };

  Eigen::Vector3d below(double log_frequency, double log_damping) const {
    const double z = std::min(0.95, std::exp(log_damping)),
                 w = 2.0 * std::numbers::pi * std::exp(log_frequency) * period_;
    const double q = std::exp(-z * w), turn = std::cos(w * std::sqrt(1.0 - z * z)), odd = 1.0 - q * q;
    return {4.0 * q * q * turn * turn + odd * odd, -4.0 * q * turn * (1.0 + q * q), 4.0 * q * q};
  }

  std::vector<Term> terms_of(const Eigen::VectorXd& unknowns) const {
    constexpr double step = 1e-5;
    std::vector<Term> terms;
    for (Eigen::Index i = 2; i + 3 < unknowns.size(); i += 4) {
      const double f = unknowns[i], z = unknowns[i + 1];
      const double angle = 2.0 * std::numbers::pi * std::exp(f) * period_, centre = std::cos(angle) - 1.0;
      terms.push_back({below(f, z), (below(f + step, z) - below(f - step, z)) / (2.0 * step),
                       (below(f, z + step) - below(f, z - step)) / (2.0 * step), centre,
                       -angle * std::sin(angle) / centre});
    }
    return terms;
  }

  double value(const std::vector<Term>& terms, const Eigen::VectorXd& unknowns, std::size_t k,
               Eigen::VectorXd* by) const {
    const double c = std::cos(2.0 * std::numbers::pi * frequencies_[k] * period_);
    const double floor = std::exp(unknowns[0]), sloped = floor * (1.0 + unknowns[1] * (c - 1.0));
    double sum = sloped;
    if (by) (*by)[0] = sloped, (*by)[1] = floor * (c - 1.0);
    Eigen::Index i = 2;
    for (const Term& term : terms) {
      const auto at = [&](const Eigen::Vector3d& v) { return v[0] + c * (v[1] + c * v[2]); };
      const double apart = (c - 1.0) / term.centre - 1.0, tilt = unknowns[i + 3];
      const double shape = std::exp(unknowns[i + 2]) / at(term.below), height = 1.0 + tilt * apart;
      sum += height * shape;
      if (by) {
        (*by)[i] = -shape * (height * at(term.by_frequency) / at(term.below) + tilt * (apart + 1.0) * term.moves);
        (*by)[i + 1] = -shape * height * at(term.by_damping) / at(term.below);
        (*by)[i + 2] = height * shape, (*by)[i + 3] = apart * shape;
      }
      i += 4;
    }
    return sum;
  }

  double period_, weight_, mean_ = 0.0;
  std::vector<double> frequencies_, powers_;
};

/// The frequency and damping ratio at which the mean of ratios stands out most from 1.
struct Start {
  double frequency = 0.0, damping = 0.0, ratio = 0.0;
};

Start start_of(const NoiseFit& fit, const std::vector<double>& ratios) {
  std::vector<double> sums(ratios.size() + 1, 0.0);
  for (std::size_t k = 0; k < ratios.size(); ++k) sums[k + 1] = sums[k] + ratios[k];
  const double step = fit.frequencies()[1] - fit.frequencies()[0];
  Start best;
  double most = 0.0;
  for (const double damping : {0.005, 0.01, 0.02, 0.04, 0.08, 0.16}) {
    for (std::size_t k = 0; k < ratios.size(); ++k) {
      const double f = fit.frequencies()[k];
      const auto half = static_cast<std::size_t>(std::max(1.0 / fit.weight(), f * damping / step));
      const std::size_t begin = k - std::min(k, half), end = std::min(ratios.size(), k + half + 1);
      const double count = fit.weight() * static_cast<double>(end - begin);
      const double mean = (sums[end] - sums[begin]) / static_cast<double>(end - begin);
      if (mean <= 1.0) continue;
      if (const double gain = count * (mean - 1.0 - std::log(mean)); gain > most)
        most = gain, best = {f, damping, mean};
    }
  }
  return best;
}

/// How much more widely powers near a frequency are spread than exponentially; at least 1.
double dispersion(const NoiseFit& fit, const std::vector<double>& ratios, const Decay& mode) {
  const double half = std::max(2.0 * mode.damping, 0.05) * mode.frequency;
  double squares = 0.0;
  int count = 0;
  for (std::size_t k = 0; k < ratios.size(); ++k) {
    if (std::abs(fit.frequencies()[k] - mode.frequency) <= half)
      squares += (ratios[k] - 1.0) * (ratios[k] - 1.0), ++count;
  }
  return count == 0 ? 1.0 : std::max(1.0, fit.cells() * squares / count);
}

}  // namespace

std::vector<DecayMode> noise_modes(const PowerSpectrum& spectrum, double seconds, const DecaySearch& search) {
  const NoiseFit fit(spectrum, seconds, search);
  if (fit.empty()) return {};
  Eigen::VectorXd unknowns = fit.noise();
  double now = fit.improve(unknowns);
  const double trials = 5.0 * (1.0 + seconds * (search.frequency_max - search.frequency_min));
  for (std::size_t mode = 0; mode < search.most + 2; ++mode) {
    const Start start = start_of(fit, fit.ratios(unknowns));
    if (start.ratio <= 1.0) break;
    Eigen::VectorXd best;
    double reached = now;
    for (const double wider : {0.5, 1.0, 2.0}) {
      Eigen::VectorXd next = fit.with(unknowns, start.frequency, wider * start.damping, start.ratio - 1.0);
      if (const double here = fit.improve(next); here < reached) reached = here, best = next;
    }
    if (best.size() == 0 || gamma_tail(2, now - reached) * trials > by_chance) break;
    unknowns = best, now = reached;
  }
  std::vector<DecayMode> found;
  const Eigen::MatrixXd sum = fit.information(unknowns).first;
  const Eigen::MatrixXd inverse = sum.ldlt().solve(Eigen::MatrixXd::Identity(sum.rows(), sum.cols()));
  const std::vector<double> ratios = fit.ratios(unknowns);
  for (Eigen::Index i = 2; i + 3 < unknowns.size(); i += 4) {
    const Decay mode{std::exp(unknowns[i]), std::exp(unknowns[i + 1])};
    const double part = fit.part(unknowns, (i - 2) / 4);
    if (mode.frequency < search.frequency_min || mode.frequency > search.frequency_max) continue;
    if (mode.damping > search.damping_max || !(part > 0.0)) continue;
    const double wider = dispersion(fit, ratios, mode);
    const auto error = [&](Eigen::Index at) {
      return inverse(at, at) >= 0.0 ? std::sqrt(wider * inverse(at, at)) : std::numeric_limits<double>::infinity();
    };
    found.push_back({mode.frequency, mode.damping, part, {error(i), error(i + 1), wider}});
  }
  std::ranges::sort(found, std::ranges::greater{}, &DecayMode::energy);
  return found;
}

}  // namespace accdec
