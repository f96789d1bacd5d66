#include <algorithm>

#include <accdec/plan/trajectory/look_ahead.hpp>
#include <accdec/simulate.hpp>

namespace accdec {
namespace {

/// Largest v >= 0 with a v^2 + b v <= c; a, b >= 0, a > 0.
double root(double a, double b, double c) {
  return c <= 0.0 ? 0.0 : 2.0 * c / (b + std::sqrt(b * b + 4.0 * a * c));
}

/// Largest v in [low, high] for which `fits`, which holds at `low` and, once it fails, stays false.
template <class Fits>
double largest(double low, double high, const Fits& fits) {
  if (fits(high)) return high;
  for (int i = 0; i < 48; ++i) {
    const double middle = 0.5 * (low + high);
    (fits(middle) ? low : high) = middle;
  }
  return low;
}

/// Largest speed <= `cap` of corner c at one end of leg b, above `other`, the speed at its other end, corner d.
double reach(const ProfileChain& chain, std::size_t b, std::size_t c, std::size_t d, double other, double cap) {
  const double room = chain.length[b] - chain.taken(d, other) + chain.way(b, other);
  if (chain.levels == 1) {
    return std::min(cap, std::max(other, root(0.5 * (chain.stretch[c] + 1.0 / chain.ramp[b]), chain.coast[c], room)));
  }
  return largest(std::min(other, cap), cap, [&](double v) { return chain.taken(c, v) + chain.way(b, v) <= room; });
}

/// If the corners of a leg together would take more than the leg, both are lowered to the same speed; a slower one
/// keeps its speed.
void share_legs(ProfileChain& chain) {
  for (std::size_t b = 0; b < chain.legs(); ++b) {
    double& first = chain.speed[b];
    double& second = chain.speed[b + 1];
    if (chain.taken(b, first) + chain.taken(b + 1, second) <= chain.length[b]) continue;
    const double a = 0.5 * (chain.stretch[b] + chain.stretch[b + 1]), c = chain.coast[b] + chain.coast[b + 1];
    const double both = a > 0.0 ? root(a, c, chain.length[b]) : chain.length[b] / c;
    const auto alone = [&](std::size_t corner, double left) {
      const double half = 0.5 * chain.stretch[corner], coast = chain.coast[corner];
      return half > 0.0 ? root(half, coast, left) : coast > 0.0 ? left / coast : chain.speed[corner];
    };
    if (first < both) {
      second = std::min(second, alone(b + 1, chain.length[b] - chain.taken(b, first)));
    } else if (second < both) {
      first = std::min(first, alone(b, chain.length[b] - chain.taken(b + 1, second)));
    } else {
      first = second = both;
    }
  }
}

/// Largest speed of corner c that its leg b, whose other end is corner d, allows.
double allowed(const ProfileChain& chain, std::size_t b, std::size_t c, std::size_t d, double cap) {
  const double other = chain.speed[d];
  if (cap <= other) return cap;  // braking towards c concerns the neighbour
  return reach(chain, b, c, d, other, cap);
}

/// Whether leg b can be driven between the speeds of its ends.
bool drivable(const ProfileChain& chain, std::size_t b, double first, double second) {
  return chain.taken(b, first) + chain.taken(b + 1, second) + std::abs(chain.way(b, second) - chain.way(b, first)) <=
         chain.length[b];
}

/// Raises corners one by one as far as both their legs allow.
void raise(ProfileChain& chain, std::size_t c) {
  double cap = chain.speed_max[c];
  if (chain.speed[c] >= cap) return;
  cap = std::min(cap, allowed(chain, c - 1, c, c - 1, cap));
  cap = std::min(cap, allowed(chain, c, c, c + 1, cap));
  const double now = chain.speed[c];
  if (cap <= now * (1.0 + 1e-6)) return;
  const auto fits = [&](double v) {
    return drivable(chain, c - 1, chain.speed[c - 1], v) && drivable(chain, c, v, chain.speed[c + 1]);
  };
  // Below a neighbour's speed, raising the own speed may help (less to ramp) or hurt (more taken): tried from the top.
  for (double v = cap, step = 0; step < 8 && v > now; ++step, v = now + 0.5 * (v - now)) {
    if (!fits(v)) continue;
    chain.speed[c] = v;
    return;
  }
}

double peak_of(const ProfileChain& chain, std::size_t b) {
  const double first = chain.speed[b], second = chain.speed[b + 1], base = std::max(first, second);
  const double room =
      chain.length[b] - chain.taken(b, first) - chain.taken(b + 1, second) + chain.way(b, first) + chain.way(b, second);
  const double feed = std::max(chain.feed[b], base);
  const auto fits = [&](double v) { return 2.0 * chain.way(b, v) + chain.peak_coast * v <= room; };
  if (!fits(base)) return base;
  if (chain.levels == 1) return std::clamp(root(1.0 / chain.ramp[b], chain.peak_coast, room), base, feed);
  return largest(base, feed, fits);
}

}  // namespace

void look_ahead(ProfileChain& chain) {
  const std::size_t n = chain.legs();
  chain.speed = chain.speed_max;
  share_legs(chain);
  for (std::size_t b = n; b-- > 0;) {
    if (chain.speed[b] > chain.speed[b + 1])
      chain.speed[b] = reach(chain, b, b, b + 1, chain.speed[b + 1], chain.speed[b]);
  }
  for (std::size_t b = 0; b < n; ++b) {
    if (chain.speed[b + 1] > chain.speed[b])
      chain.speed[b + 1] = reach(chain, b, b + 1, b, chain.speed[b], chain.speed[b + 1]);
  }
  for (int round = 0; round < 2; ++round) {
    for (std::size_t c = 1; c < n; ++c) raise(chain, c);
    for (std::size_t c = n; c-- > 1;) raise(chain, c);
  }
  chain.peak.resize(n);
  for (std::size_t b = 0; b < n; ++b) chain.peak[b] = peak_of(chain, b);
}

}  // namespace accdec
