#include <algorithm>
#include <cmath>
#include <numeric>

#include <accdec/design/quantise.hpp>
#include <accdec/verify.hpp>

// In quantise.hpp.

namespace accdec {
namespace {

/// Rounds shares of `total` by their cumulative sums: no partial sum is off by more than one unit.
/// @param offset  0 to 1: where a fraction goes up; 0.5 rounds to the nearest
Coefficients round_sums(const std::vector<double>& shares, std::int64_t total, double offset) {
  Coefficients rounded(shares.size());
  double sum = 0.0;
  std::int64_t before = 0;
  for (std::size_t i = 0; i < shares.size(); ++i) {
    sum += shares[i];
    const auto here =
        i + 1 == shares.size() ? total : std::min(total, static_cast<std::int64_t>(std::floor(sum + offset)));
    rounded[i] = std::max<std::int64_t>(0, here - before);
    before += rounded[i];
  }
  rounded.back() += total - before;
  return rounded;
}

Coefficients round_remainders(const std::vector<double>& shares, std::int64_t total) {
  Coefficients rounded(shares.size());
  std::transform(shares.begin(), shares.end(), rounded.begin(),
                 [](double share) { return static_cast<std::int64_t>(std::floor(share)); });
  std::vector<std::size_t> order(shares.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return shares[a] - std::floor(shares[a]) > shares[b] - std::floor(shares[b]);
  });
  std::int64_t left = total - std::accumulate(rounded.begin(), rounded.end(), std::int64_t{0});
  for (std::size_t i = 0; left > 0; i = (i + 1) % order.size(), --left) ++rounded[order[i]];
  for (std::size_t i = order.size(); left < 0; ++left) {
    while (rounded[order[(i = (i == 0 ? order.size() : i) - 1)]] == 0) {
    }
    --rounded[order[i]];
  }
  return rounded;
}

/// Exchanges units until every limit holds.
class Exchange {
 public:
  Exchange(const Task& task, const std::vector<int>& delays, const std::function<bool()>& stop)
      : task_(task), delays_(delays), stop_(stop) {}

  /// @return whether it ended with all limits held
  bool repair(Coefficients& c) {
    double excess = excess_of(c);
    bool better = true;
    while (better && excess > 0.0) {
      better = false;
      const int n = static_cast<int>(c.size());
      // Steps of acceleration are mended by neighbours, everything else by farther exchanges.
      for (int distance = 1; distance < n && excess > 0.0; ++distance) {
        for (int i = 0; i + distance < n && excess > 0.0; ++i) {
          for (const bool forward : {true, false}) {
            if (stop_ && stop_()) return false;
            if (try_move(c, forward ? i : i + distance, forward ? i + distance : i, excess)) better = true;
          }
        }
        if (better && distance >= 4) break;
      }
    }
    return !(excess > 0.0);
  }

 private:
  /// Sum of what all limits are exceeded by.
  double excess_of(const Coefficients& c) {
    const VerificationReport report =
        verify_by_simulation(task_, filter_of_coefficients(c), delays_, &limits_, &corners_);
    if (report.feasible) return 0.0;
    double excess = 0.0;
    for (const LimitUse& use : limits_) excess += std::clamp(use.utilisation - 1.0, 0.0, 1e3);
    return std::max(excess, 1e-15);
  }

  /// One unit from one tap to another, mirrored where taps must be symmetric.
  bool move(Coefficients& c, int from, int to) const {
    const auto shift = [&](int i, std::int64_t by) { c[static_cast<std::size_t>(i)] += by; };
    const int last = static_cast<int>(c.size()) - 1;
    shift(from, -1), shift(to, 1);
    if (task_.design.symmetric) shift(last - from, -1), shift(last - to, 1);
    return std::all_of(c.begin(), c.end(), [](std::int64_t unit) { return unit >= 0; });
  }

  bool try_move(Coefficients& c, int from, int to, double& excess) {
    Coefficients moved = c;
    if (!move(moved, from, to)) return false;
    const double then = excess_of(moved);
    if (!(then < excess * (1.0 - 1e-9))) return false;
    c = std::move(moved), excess = then;
    return true;
  }

  const Task& task_;
  const std::vector<int>& delays_;
  const std::function<bool()>& stop_;
  std::vector<LimitUse> limits_;
  std::vector<CornerResult> corners_;
};

/// All roundings that are tried, the likely ones first.
std::vector<Coefficients> roundings(const std::vector<double>& shares, std::int64_t total) {
  std::vector<Coefficients> all{round_remainders(shares, total)};
  for (const double offset : {0.5, 0.25, 0.75}) all.push_back(round_sums(shares, total, offset));
  return all;
}

/// The same for symmetric taps: those of one half, and the middle tap takes the rest.
std::vector<Coefficients> symmetric_roundings(const std::vector<double>& shares, std::int64_t total) {
  const std::size_t half = shares.size() / 2;
  if (half == 0) return {{total}};
  const bool middle = shares.size() % 2 == 1;
  const std::int64_t of_half = middle ? std::llround(0.5 * (static_cast<double>(total) - shares[half])) : total / 2;
  std::vector<Coefficients> all =
      roundings(std::vector(shares.begin(), shares.begin() + static_cast<std::ptrdiff_t>(half)), of_half);
  for (Coefficients& c : all) {
    const Coefficients first = c;
    if (middle) c.push_back(total - 2 * of_half);
    c.insert(c.end(), first.rbegin(), first.rend());
  }
  return all;
}

}  // namespace

Filter filter_of_coefficients(const Coefficients& coefficients) {
  // Divided here, by a power of two: a filter that scales taps itself rounds twice.
  const double total = std::accumulate(coefficients.begin(), coefficients.end(), 0.0);
  std::vector<double> taps;
  for (const std::int64_t unit : coefficients) taps.push_back(static_cast<double>(unit) / total);
  return Filter(std::move(taps));
}

std::optional<Coefficients> exact_coefficients(const Filter& filter, int bits) {
  Coefficients coefficients;
  for (const double tap : filter.taps()) {
    const double scaled = std::ldexp(tap, bits);
    if (scaled != std::floor(scaled)) return std::nullopt;
    coefficients.push_back(static_cast<std::int64_t>(scaled));
  }
  return coefficients;
}

std::optional<Coefficients> round_under_limits(const Task& task, const Filter& filter, const std::vector<int>& delays,
                                               int bits, const std::function<bool()>& stop) {
  const std::int64_t total = std::int64_t{1} << bits;
  std::vector<double> shares;
  for (const double tap : filter.taps()) shares.push_back(std::ldexp(tap, bits));
  std::vector<Coefficients> tried =
      task.design.symmetric ? symmetric_roundings(shares, total) : roundings(shares, total);
  for (const Coefficients& c : tried) {
    if (verify_by_simulation(task, filter_of_coefficients(c), delays).feasible) return c;
  }
  Exchange exchange(task, delays, stop);
  for (Coefficients& c : tried) {
    if (exchange.repair(c)) return c;
    if (stop && stop()) break;
  }
  return std::nullopt;
}

}  // namespace accdec
