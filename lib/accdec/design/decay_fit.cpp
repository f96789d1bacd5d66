#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Cholesky>
#include <Eigen/Dense>

#include <accdec/design/decay_fit.hpp>
#include <accdec/design/power_spectrum.hpp>

namespace accdec {
namespace {

constexpr double damping_least = 1e-5;

std::vector<Decay> moved(std::vector<Decay> poles, const Eigen::VectorXd& step, const DecaySearch& search) {
  for (std::size_t p = 0; p < poles.size(); ++p) {
    const auto i = 2 * static_cast<Eigen::Index>(p);
    poles[p].frequency *= std::exp(step[i]);
    poles[p].damping = std::clamp(poles[p].damping * std::exp(step[i + 1]), damping_least, 2.0 * search.damping_max);
    poles[p].damping = std::min(poles[p].damping, 0.9);
  }
  return poles;
}

/// The variance of noise near a frequency, per sample. Vibrations that were fitted take a part of it away.
double variance_near(const PowerSpectrum& left, double samples, double period, double frequency, double taken) {
  const double cell = 1.0 / (samples * period);
  const double half = std::max(0.15 * frequency, 2.0 * taken * cell);
  double sum = 0.0;
  int count = 0;
  for (std::size_t k = 1; k < left.power.size(); ++k) {
    if (std::abs(left.step * static_cast<double>(k) - frequency) <= half) sum += left.power[k], ++count;
  }
  if (count == 0) return 0.0;
  const double cells = std::max(1.0, count * left.step / cell);
  return sum / count / samples * cells / std::max(0.25 * cells, cells - taken);
}

}  // namespace

Eigen::MatrixXd decaying_waves(const std::vector<Decay>& poles, Eigen::Index rows, double period) {
  Eigen::MatrixXd basis(rows, 1 + 2 * static_cast<Eigen::Index>(poles.size()));
  basis.col(0).setOnes();
  Eigen::Index column = 1;
  for (const Decay& pole : poles) {
    const double w = 2.0 * std::numbers::pi * pole.frequency * period;
    const double turn = w * std::sqrt(1.0 - pole.damping * pole.damping), fall = std::exp(-pole.damping * w);
    const double c = fall * std::cos(turn), s = fall * std::sin(turn);
    double x = 1.0, y = 0.0;
    double *cosine = basis.col(column).data(), *sine = basis.col(column + 1).data();
    for (Eigen::Index k = 0; k < rows; ++k) {
      cosine[k] = x, sine[k] = y;
      const double before = x;
      x = c * x - s * y, y = s * before + c * y;
      if (std::abs(x) + std::abs(y) < 1e-30) x = y = 0.0;
    }
    column += 2;
  }
  return basis;
}

DecayFit::DecayFit(const std::vector<double>& signal, std::vector<Stretch> stretches, double period)
    : signal_(signal), stretches_(std::move(stretches)), period_(period) {
  for (const Stretch& s : stretches_) samples_ += s.end - s.begin;
}

std::vector<std::vector<double>> DecayFit::in_stretches(const Eigen::VectorXd& all) const {
  std::vector<std::vector<double>> parts;
  const double* at = all.data();
  for (const Stretch& s : stretches_) parts.emplace_back(at, at + (s.end - s.begin)), at += s.end - s.begin;
  return parts;
}

Eigen::VectorXd DecayFit::rest(const std::vector<Decay>& poles, std::vector<double>* parts) const {
  Eigen::VectorXd all(static_cast<Eigen::Index>(samples_));
  if (parts) parts->assign(poles.size(), 0.0);
  Eigen::Index longest = 0, at = 0;
  for (const Stretch& s : stretches_) longest = std::max(longest, static_cast<Eigen::Index>(s.end - s.begin));
  const Eigen::MatrixXd waves = decaying_waves(poles, longest, period_);
  for (const Stretch& s : stretches_) {
    const auto rows = static_cast<Eigen::Index>(s.end - s.begin);
    const auto basis = waves.topRows(rows);
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

Eigen::MatrixXd DecayFit::slopes(const std::vector<Decay>& poles, const Eigen::VectorXd& now,
                                 const DecaySearch& search) const {
  const auto size = static_cast<Eigen::Index>(2 * poles.size());
  Eigen::MatrixXd all(now.size(), size);
  for (Eigen::Index i = 0; i < size; ++i) {
    Eigen::VectorXd step = Eigen::VectorXd::Zero(size);
    step[i] = i % 2 == 0 ? 1e-5 : 1e-3;
    all.col(i) = (rest(moved(poles, step, search)) - now) / step[i];
  }
  return all;
}

double DecayFit::improve(std::vector<Decay>& poles, const DecaySearch& search) const {
  constexpr int rounds = 15;
  Eigen::VectorXd now = rest(poles);
  double sum = now.squaredNorm(), damp = 1e-3;
  for (int round = 0; round < rounds && sum > 0.0; ++round) {
    const Eigen::MatrixXd by = slopes(poles, now, search);
    const Eigen::MatrixXd gram = by.transpose() * by;
    const Eigen::VectorXd down = by.transpose() * now;
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

std::vector<DecayError> DecayFit::errors(const std::vector<Decay>& poles, const DecaySearch& search) const {
  const Eigen::VectorXd now = rest(poles);
  const Eigen::MatrixXd by = slopes(poles, now, search);
  const Eigen::MatrixXd inverse = (by.transpose() * by).ldlt().solve(Eigen::MatrixXd::Identity(by.cols(), by.cols()));
  const double samples = static_cast<double>(samples_);
  const double fitted = static_cast<double>(stretches_.size() * (2 * poles.size() + 1) + 2 * poles.size());
  const double all = now.squaredNorm() / std::max(0.25 * samples, samples - fitted);
  const PowerSpectrum left = power_spectrum({now.data(), samples_}, period_);
  std::vector<DecayError> found;
  for (std::size_t p = 0; p < poles.size(); ++p) {
    const double f = poles[p].frequency;
    const auto close = [&](const Decay& d) { return std::abs(d.frequency / f - 1.0) < 0.15; };
    const auto beside = static_cast<double>(std::ranges::count_if(poles, close));
    const double taken = beside * static_cast<double>(stretches_.size() + 1);
    const double near = variance_near(left, samples, period_, f, taken);
    const auto error = [&](Eigen::Index i) {
      const double square = inverse(i, i) * std::max(near, all);
      return square >= 0.0 ? std::sqrt(square) : std::numeric_limits<double>::infinity();
    };
    const auto i = 2 * static_cast<Eigen::Index>(p);
    found.push_back({error(i), error(i + 1), all > 0.0 ? near / all : 1.0});
  }
  return found;
}

}  // namespace accdec
