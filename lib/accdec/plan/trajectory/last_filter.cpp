#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>

#include <accdec/families/cascade.hpp>
#include <accdec/family.hpp>
#include <accdec/filter.hpp>
#include <accdec/machine.hpp>
#include <accdec/plan/trajectory/available.hpp>
#include <accdec/plan/trajectory/last_filter.hpp>

namespace accdec {
namespace {

constexpr std::size_t table_steps = 256;

/// |x| averaged over an interval of length tau around it.
double mean_distance(double x, double tau) {
  const double distance = std::abs(x);
  return 2.0 * distance >= tau ? distance : x * x / tau + 0.25 * tau;
}

/// s, see LastFilter::swing_time.
double swing_time_of(const Filter& filter, double period) {
  double variation = filter.tap(0);
  for (int i = 0; i <= filter.order(); ++i) variation += std::abs(filter.tap(i + 1) - filter.tap(i));
  return period / (0.5 * variation);
}

}  // namespace

LastFilter::LastFilter(Filter filter, double period) : filter_(std::move(filter)) {
  const int n = filter_.order();
  span_ = (n + 1) * period;
  bool equal = true;
  for (int i = 0; i <= n; ++i) {
    equal = equal && std::abs(filter_.tap(i) - filter_.tap(0)) <= 1e-12 * filter_.tap(0);
    const double x = (i - filter_.mean_delay()) * period;
    variance_ += filter_.tap(i) * x * x;
    if (filter_.tap(i) > 0.0) reach_ = std::max(reach_, std::abs(x));
  }
  swing_time_ = swing_time_of(filter_, period);
  boxcar_ = equal ? n + 1 : 0;
  if (equal) return;
  deviation_.step = 2.0 * reach_ / table_steps;
  beyond_.step = reach_ / table_steps;
  for (std::size_t k = 0; k <= table_steps; ++k) {
    const double tau = deviation_.step * static_cast<double>(k), h = beyond_.step * static_cast<double>(k);
    double mean = 0.0, after = 0.0, before = 0.0;
    for (int i = 0; i <= n; ++i) {
      const double x = (i - filter_.mean_delay()) * period;
      mean += filter_.tap(i) * mean_distance(x, tau);
      after += filter_.tap(i) * std::pow(std::max(0.0, x - h), 2);
      before += filter_.tap(i) * std::pow(std::max(0.0, -x - h), 2);
    }
    deviation_.values.push_back(mean);
    beyond_.values.push_back(std::max(after, before));
  }
}

LastFilter::LastFilter(int taps, double period) : LastFilter(accdec::boxcar(taps - 1), period) {}

double LastFilter::Table::at(double x) const {
  const double place = std::max(0.0, x / step);
  if (place >= static_cast<double>(table_steps)) return values.back();
  const auto k = static_cast<std::size_t>(place);
  const double part = place - static_cast<double>(k);
  return (1.0 - part) * values[k] + part * values[k + 1];
}

double LastFilter::deviation_of(double tau) const {
  return tau >= 2.0 * reach_ ? variance_ / tau + 0.25 * tau : deviation_.at(tau);
}

double LastFilter::beyond_of(double h) const {
  return h >= reach_ ? 0.0 : beyond_.at(h);
}

namespace {

std::vector<int> jerk_boxcars(double jerk_time, double period) {
  std::vector<int> taps;
  for (const double factor : {0.35, 0.5, 0.7, 0.85, 1.0, 1.15, 1.3, 1.5, 2.0}) {
    const double count = std::ceil(jerk_time * factor / period - 1e-6);
    taps.push_back(static_cast<int>(std::clamp(count, 1.0, 100'000.0)));
  }
  taps.erase(std::unique(taps.begin(), taps.end()), taps.end());
  return taps;
}

/// Small lengths one by one, longer ones in steps that grow with them.
std::vector<int> lengths(int most) {
  std::vector<int> all;
  for (double n = 1.0; n <= most; n = std::max(n + 1.0, n * 1.06)) all.push_back(static_cast<int>(n));
  return all;
}

/// Two averages, the longer first, with pairs of equal impulses behind them.
struct Candidate {
  std::array<int, 2> lengths;
  std::span<const int> pairs;  ///< delay of each

  Filter filter() const {
    Filter all = make_filter(find_family("trapezoid")->member(lengths));
    for (const int delay : pairs) all = with_pairs(all, 1, delay);
    return all;
  }
};

bool holds_bounds(const Candidate& candidate, const Machine& modes, double period) {
  // A candidate that fails at some of the frequencies need not be looked at closely.
  constexpr int places = 8;
  const auto frequency = [&](const Mode& mode, int i) {
    return mode.frequency_low + (mode.frequency_high - mode.frequency_low) * i / places;
  };
  for (const Mode& mode : modes.modes) {
    for (int i = 0; i <= places && mode.undamped(); ++i) {
      const double x = 2.0 * std::numbers::pi * frequency(mode, i) * period;
      if (cascade_response(x, candidate.lengths, candidate.pairs) > mode.residual_max) return false;
    }
  }
  const Filter filter = candidate.filter();
  for (const Mode& mode : modes.modes) {
    for (int i = 0; i <= places && !mode.undamped(); i += places / 2) {
      if (residual_vibration(filter, frequency(mode, i), period, mode.damping_low) > mode.residual_max) return false;
    }
  }
  const std::vector<LimitUse> uses = vibration_utilisation(filter, period, modes);
  return std::all_of(uses.begin(), uses.end(), [](const LimitUse& use) { return use.utilisation <= 1.0; });
}

/// No pair, one or two at half a period of each mode.
std::vector<std::vector<int>> choices_of_pairs(const Machine& modes, double period) {
  std::vector<std::vector<int>> choices{{}};
  for (const Mode& mode : modes.modes) {
    const double middle = 0.5 * (mode.frequency_low + mode.frequency_high);
    const int half = static_cast<int>(std::clamp(std::round(0.5 / (middle * period)), 1.0, 2000.0));
    for (std::size_t i = choices.size(); i-- > 0 && choices.size() < 30;) {
      for (const int count : {1, 2}) {
        std::vector<int> with = choices[i];
        with.insert(with.end(), static_cast<std::size_t>(count), half);
        choices.push_back(std::move(with));
      }
    }
  }
  return choices;
}

}  // namespace

std::vector<Filter> last_filters(const Machine& machine, double period, double fastest, std::size_t most,
                                 const Deadline& deadline) {
  Machine modes;
  double slowest = unlimited;
  for (const Mode& mode : machine.modes) {
    if (!(mode.residual_max < 1.0)) continue;
    modes.modes.push_back(mode);
    slowest = std::min(slowest, mode.frequency_low);
  }
  const std::optional<double> jerk_time = longest_jerk_time(machine, fastest);
  std::vector<Filter> found;
  if (modes.modes.empty()) {
    if (!jerk_time) return {boxcar(0)};
    for (const int taps : jerk_boxcars(*jerk_time, period)) found.push_back(boxcar(taps - 1));
    return found;
  }
  // Two and a half periods of the slowest mode are longer than any of these shapes needs for it.
  const double wanted = std::max(2.5 / slowest, 1.2 * jerk_time.value_or(0.0)) / period;
  const std::vector<int> all = lengths(static_cast<int>(std::clamp(wanted, 4.0, 2000.0)));
  std::vector<std::pair<double, Filter>> holding;
  for (const std::vector<int>& pairs : choices_of_pairs(modes, period)) {
    for (const int longer : all) {
      for (const int shorter : all) {
        if (shorter > longer || deadline.over()) break;
        const Candidate candidate{{longer, shorter}, pairs};
        // First what takes less time to find out.
        if (jerk_time && swing_time_of(candidate.filter(), period) < 0.5 * *jerk_time) continue;
        if (!holds_bounds(candidate, modes, period)) continue;
        const LastFilter last(candidate.filter(), period);
        holding.emplace_back(last.deviation(0.0), last.filter());
        break;  // a longer second average only adds
      }
    }
  }
  std::stable_sort(holding.begin(), holding.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  for (std::size_t i = 0; i < std::min(most, holding.size()); ++i) found.push_back(holding[i].second);
  return found;
}

}  // namespace accdec
