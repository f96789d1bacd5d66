#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <stdexcept>

#include <fmt/format.h>

#include <accdec/families/poles.hpp>

namespace accdec {
namespace {

constexpr int most_poles = 3;

/// A sample of poles in series as a chain: part [s][t] of what is in pole s is in pole t a sample later. Nothing is
/// subtracted, so that powers keep their digits.
using Chain = std::array<std::array<double, most_poles>, most_poles>;

Chain product(const Chain& a, const Chain& b) {
  Chain c{};
  for (std::size_t s = 0; s < most_poles; ++s) {
    for (std::size_t t = s; t < most_poles; ++t) {
      for (std::size_t r = s; r <= t; ++r) c[s][t] += a[s][r] * b[r][t];
    }
  }
  return c;
}

Chain one_sample(const std::vector<double>& constants) {
  Chain chain{};
  for (std::size_t s = 0; s < constants.size(); ++s) {
    double arrived = 1.0;
    for (std::size_t t = s; t < constants.size(); ++t) {
      chain[s][t] = arrived * std::exp(-1.0 / constants[t]);
      arrived *= -std::expm1(-1.0 / constants[t]);
    }
  }
  return chain;
}

double rest(const Chain& chain) {
  return chain[0][0] + chain[0][1] + chain[0][2];
}

}  // namespace

int order_of_poles(const std::vector<double>& constants, int order_max) {
  // The rest of one pole is an exponential: exact where it ends at pole_rest itself.
  if (constants.size() == 1) {
    const double taps = std::ceil(-std::log(pole_rest) * constants.front() * (1.0 - 1e-12));
    return static_cast<int>(std::min(taps, order_max + 2.0)) - 1;
  }
  std::vector<Chain> powers{one_sample(constants)};  // of 1, 2, 4 .. samples
  int samples = 1;
  while (rest(powers.back()) > pole_rest && samples <= order_max) {
    powers.push_back(product(powers.back(), powers.back()));
    samples *= 2;
  }
  if (rest(powers.back()) > pole_rest) return order_max + 1;
  // The most samples behind which there is still too much, a power at a time.
  Chain behind{};
  for (std::size_t s = 0; s < most_poles; ++s) behind[s][s] = 1.0;
  int most = 0;
  for (std::size_t i = powers.size(); i-- > 0;) {
    const Chain longer = product(behind, powers[i]);
    if (rest(longer) > pole_rest) behind = longer, most += 1 << i;
  }
  return std::min(most, order_max + 1);
}

FilterSpec cut_pole(double constant) {
  return cut_poles({constant});
}

FilterSpec cut_poles(const std::vector<double>& constants) {
  constexpr int longest = 1'000'000;
  std::vector<double> on = constants;
  std::erase(on, 0.0);
  if (on.empty()) return {.kind = Shape::exponential, .ratio = 1.0};
  const int order = order_of_poles(on, longest);
  if (on.size() == 1) return {.kind = Shape::exponential, .order = order, .ratio = std::exp(-1.0 / on.front())};
  std::vector<double> taps(static_cast<std::size_t>(order) + 1, 0.0);
  taps.front() = 1.0;
  for (const double constant : on) {
    double before = 0.0;
    for (double& tap : taps) before = tap += std::exp(-1.0 / constant) * before;
  }
  return {.kind = Shape::taps, .order = order, .taps = std::move(taps)};
}

std::vector<Poles> all_poles(const std::vector<std::vector<int>>& allowed, int order_max) {
  constexpr std::size_t most = 10'000'000;
  std::vector<Poles> all;
  std::vector<int> constants;
  const std::function<void(std::size_t)> stage = [&](std::size_t s) {
    std::vector<double> on(constants.begin(), constants.end());
    std::erase(on, 0.0);
    const int order = on.empty() ? 0 : order_of_poles(on, order_max);
    if (s == allowed.size()) {
      if (all.size() >= most)
        throw std::invalid_argument(
            fmt::format("the poles in series have more than {} settings up to order {}; allowed are fewer, by "
                        "`length_max_ms`, `length_step_ms` or `order_max`",
                        most, order_max));
      all.push_back({order, constants});
      return;
    }
    for (const int constant : allowed[s]) {
      if (s > 0 && allowed[s] == allowed[s - 1] && constant > constants.back()) break;
      std::vector<double> more = on;
      if (constant > 0) more.push_back(constant);
      if (!more.empty() && order_of_poles(more, order_max) > order_max) break;
      constants.push_back(constant);
      stage(s + 1);
      constants.pop_back();
    }
  };
  stage(0);
  std::stable_sort(all.begin(), all.end(), [](const Poles& a, const Poles& b) { return a.order < b.order; });
  return all;
}

}  // namespace accdec
