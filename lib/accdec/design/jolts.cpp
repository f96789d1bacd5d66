#include <algorithm>
#include <cmath>

#include <Eigen/QR>

#include <accdec/design/jolts.hpp>

namespace accdec {
namespace {

constexpr double rises = 2.5;  // energy of a period behind a jolt, over that before it
constexpr double loud = 0.02;  // of the largest energy of a period: quieter jolts are not used

/// Sums of squares of samples from one to before another.
class Energies {
 public:
  explicit Energies(const std::vector<double>& signal) : sums_(signal.size() + 1, 0.0) {
    for (std::size_t k = 0; k < signal.size(); ++k) sums_[k + 1] = sums_[k] + signal[k] * signal[k];
  }
  double of(std::size_t begin, std::size_t count) const {
    return sums_[std::min(begin + count, sums_.size() - 1)] - sums_[std::min(begin, sums_.size() - 1)];
  }

 private:
  std::vector<double> sums_;
};

}  // namespace

std::vector<Stretch> jolts_by_rise(const std::vector<double>& signal, std::size_t window) {
  const Energies energies(signal);
  const auto behind = [&](std::size_t k) { return energies.of(k, window); };
  const auto before = [&](std::size_t k) { return energies.of(k - std::min(k, window), std::min(k, window)); };
  double largest = 0.0;
  for (std::size_t k = 0; k + window < signal.size(); k += window) largest = std::max(largest, behind(k));
  std::vector<Stretch> found;
  for (std::size_t k = 0; k + window < signal.size(); ++k) {
    const double rise = behind(k) - before(k);
    if (behind(k) < rises * before(k) || behind(k) < loud * largest) continue;
    if (!found.empty() && k - found.back().begin <= window) {
      if (rise > behind(found.back().begin) - before(found.back().begin)) found.back() = {k, k + 1};
    } else {
      found.push_back({k, k + 1});
    }
  }
  return found;
}

std::vector<Stretch> jolts_by_fit(const std::vector<double>& signal, const std::vector<Decay>& poles, double period,
                                  double part) {
  double lowest = poles.front().frequency;
  for (const Decay& pole : poles) lowest = std::min(lowest, pole.frequency);
  const std::size_t unknowns = 1 + 2 * poles.size();
  const auto length = std::max(2 * unknowns + 4, static_cast<std::size_t>(2.0 / (lowest * period)));
  if (signal.size() < 4 * length) return {};
  const auto rows = static_cast<Eigen::Index>(length);
  const Eigen::MatrixXd waves = decaying_waves(poles, rows, period);
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(rows, waves.cols());
  const Eigen::MatrixXd onto = waves.householderQr().householderQ() * identity;
  const Energies energies(signal);
  std::vector<double> left;
  for (std::size_t k = 0; k + length <= signal.size(); ++k) {
    const Eigen::Map<const Eigen::VectorXd> values(signal.data() + k, rows);
    left.push_back(std::max(0.0, energies.of(k, length) - (onto.transpose() * values).squaredNorm()));
  }
  std::vector<double> sorted = left;
  std::ranges::sort(sorted);
  // A fifth of the windows has no jolt. Their energies are spread as chi squared.
  const double free = static_cast<double>(length - unknowns), noise = sorted[sorted.size() / 5] / free;
  const double chance = noise * (free + 7.0 * std::sqrt(2.0 * free) + 30.0);
  std::vector<Stretch> found;
  for (std::size_t k = 0; k < left.size(); ++k) {
    if (left[k] <= chance + part * energies.of(k, length)) continue;
    const std::size_t begin = k;
    std::size_t end = k;
    for (std::size_t j = k; j < left.size() && j <= end + 2; ++j)
      if (left[j] > chance + part * energies.of(j, length)) end = j;
    // The first window that does not fit ends behind the first sample of the jolt; the last begins at its last sample.
    const std::size_t first = std::min(begin + length - 1, end);
    found.push_back({std::min(first, end), std::max(begin + length - 1, end) + 1});
    k = end + 2;
  }
  return found;
}

std::vector<Stretch> between(const std::vector<Stretch>& jolts, std::size_t samples, std::size_t window) {
  std::vector<Stretch> stretches;
  for (std::size_t j = 0; j < jolts.size(); ++j) {
    const std::size_t begin = jolts[j].end + std::max<std::size_t>(2, window / 8);
    const bool last = j + 1 == jolts.size();
    const std::size_t end = last ? samples : jolts[j + 1].begin - std::min(jolts[j + 1].begin, window / 4 + 2);
    if (end >= begin + 2 * window) stretches.push_back({begin, end});
  }
  return stretches;
}

void shorten(std::vector<Stretch>& stretches, const std::vector<double>& values, std::size_t window,
             std::size_t longest, std::size_t most) {
  const Energies sums(values);
  const auto energy = [&](std::size_t from) { return sums.of(from, window); };
  std::vector<double> energies;
  double largest = 0.0;
  for (std::size_t k = 0; k + window < values.size(); k += window) energies.push_back(energy(k));
  for (const Stretch& s : stretches) largest = std::max(largest, energy(s.begin));
  std::ranges::sort(energies);
  const double quiet = 2.0 * energies[energies.size() / 20];
  std::erase_if(stretches, [&](const Stretch& s) { return energy(s.begin) < loud * largest; });
  std::size_t all = 0;
  for (Stretch& s : stretches) {
    std::size_t k = s.begin + 4 * window;
    while (k + window < s.end && energy(k) > quiet) k += window;
    s.end = std::min({s.end, k + (k - s.begin) / 4, s.begin + longest});
    all += s.end - s.begin;
  }
  const auto louder = [&](const Stretch& a, const Stretch& b) { return energy(a.begin) > energy(b.begin); };
  std::ranges::stable_sort(stretches, louder);
  for (; all > most && stretches.size() > 1; stretches.pop_back()) all -= stretches.back().end - stretches.back().begin;
  if (!stretches.empty()) stretches.front().end = std::min(stretches.front().end, stretches.front().begin + most);
}

}  // namespace accdec
