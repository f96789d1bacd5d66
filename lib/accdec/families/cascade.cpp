#include <algorithm>
#include <cmath>

#include <accdec/families/cascade.hpp>

namespace accdec {
namespace {

/// C(n + d, d), n >= 0, d from 0 to 4.
double binomial(int n, int d) {
  double product = 1.0;
  constexpr std::array<double, 5> factorial{1.0, 1.0, 2.0, 6.0, 24.0};
  for (int i = 1; i <= d; ++i) product *= n + i;
  return product / factorial[static_cast<std::size_t>(d)];
}

/// The least squared distance from the corner, with leg 1 at least p and leg 2 at least q away.
double nearest_squared(double p, double q, double cos_interior) {
  // On a flat corner, one leg is nearest when the other is farther away than its bound.
  q = std::max(q, -p * cos_interior);
  p = std::max(p, -q * cos_interior);
  return p * p + q * q + 2.0 * p * q * cos_interior;
}

}  // namespace

Cascade::Cascade(std::span<const int> lengths, int pairs, int pair_delay, double outer)
    : averages_(static_cast<int>(lengths.size())) {
  double whole = static_cast<double>(1 << pairs);
  for (const int length : lengths) order_ += length - 1, whole *= length;
  const double copies[3][3] = {{1.0, 0.0, 0.0}, {1.0, 1.0, 0.0}, {4.0 * outer, 4.0 - 8.0 * outer, 4.0 * outer}};
  for (int copy = 0; copy <= pairs; ++copy) {
    for (unsigned set = 0; set < 1U << lengths.size(); ++set) {
      Term term{copy * pair_delay, copies[pairs][copy] / whole};
      for (std::size_t i = 0; i < lengths.size(); ++i) {
        if ((set >> i & 1U) != 0) term.offset += lengths[i], term.factor = -term.factor;
      }
      terms_[count_++] = term;
    }
  }
  order_ += pairs * (pairs > 0 ? pair_delay : 0);
}

double Cascade::sum(int k, int times) const {
  double total = 0.0;
  for (std::size_t i = 0; i < count_; ++i) {
    if (k >= terms_[i].offset) total += terms_[i].factor * binomial(k - terms_[i].offset, averages_ - 1 + times);
  }
  return total;
}

double Cascade::tap(int k) const {
  return k < 0 || k > order_ ? 0.0 : sum(std::min(k, order_ - k), 0);
}

double Cascade::gone(int k) const {
  return 2 * k < order_ ? sum(k, 1) : 1.0 - sum(order_ - 1 - k, 1);
}

double Cascade::elapsed(int m) const {
  return 2 * m <= order_ ? sum(m - 1, 2) : m - 0.5 * order_ + sum(order_ - m - 1, 2);
}

double cascade_response(double x, std::span<const int> lengths, std::span<const int> pair_delays) {
  const double half = 0.5 * x, sine = std::sin(half);
  double response = 1.0;
  for (const int length : lengths) {
    const double below = length * sine;
    if (std::abs(below) >= 1e-9 * length) response *= std::abs(std::sin(length * half) / below);
  }
  for (const int delay : pair_delays) response *= std::abs(std::cos(half * delay));
  return response;
}

namespace {

/// @param remaining,elapsed  p(k) and q(k), in full-speed samples
template <class Remaining, class Elapsed>
bool may_hold(const Remaining& remaining, const Elapsed& elapsed, int order, double cos_interior, double in, double out,
              int delay, double allowed) {
  const auto nearest = [&](int k) {
    return nearest_squared(in * remaining(k), out * elapsed(k - delay), cos_interior);
  };
  int first = std::max(0, delay), last = order;
  if (first >= last) return true;
  // Start in the middle. There both legs are equally far away, which is the minimum at equal feeds.
  int k = first + (last - first) / 2;
  for (;;) {
    const double here = nearest(k);
    if (here <= allowed * allowed) return true;
    if (first == last) return false;
    const bool falls = k < last && nearest(k + 1) < here;
    if (falls) {
      first = k + 1;
    } else {
      last = k;
      if (k == first) return false;
    }
    k = first + (last - first) / 2;
  }
}

}  // namespace

bool may_hold_error(const Cascade& cascade, double cos_interior, double in, double out, int delay, double allowed) {
  return may_hold([&](int k) { return cascade.remaining(k); }, [&](int k) { return cascade.elapsed(k); },
                  cascade.order(), cos_interior, in, out, delay, allowed);
}

bool may_hold_error(const Filter& filter, double cos_interior, double in, double out, int delay, double allowed) {
  return may_hold([&](int k) { return filter.remaining_moment(k); }, [&](int k) { return filter.elapsed_moment(k); },
                  filter.order(), cos_interior, in, out, delay, allowed);
}

}  // namespace accdec
