#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace accdec {

/// Closed interval with outward rounding: every operation is widened by one ulp on either side, which covers round to
/// nearest.
struct Interval {
  double lo = 0.0, hi = 0.0;
  Interval() = default;
  Interval(double x) : lo(x), hi(x) {}
  Interval(double low, double high) : lo(low), hi(high) {}
  static Interval widened(double low, double high) {
    constexpr double inf = std::numeric_limits<double>::infinity();
    return {std::nextafter(low, -inf), std::nextafter(high, inf)};
  }
  Interval magnitude() const {
    if (lo >= 0.0) return *this;
    if (hi <= 0.0) return {-hi, -lo};
    return {0.0, std::max(-lo, hi)};
  }
};

inline Interval operator+(const Interval& a, const Interval& b) {
  return Interval::widened(a.lo + b.lo, a.hi + b.hi);
}
inline Interval operator-(const Interval& a, const Interval& b) {
  return Interval::widened(a.lo - b.hi, a.hi - b.lo);
}
inline Interval operator*(const Interval& a, const Interval& b) {
  if ((a.lo == 0.0 && a.hi == 0.0) || (b.lo == 0.0 && b.hi == 0.0)) return {};
  const double p = a.lo * b.lo, q = a.lo * b.hi, r = a.hi * b.lo, s = a.hi * b.hi;
  return Interval::widened(std::min({p, q, r, s}), std::max({p, q, r, s}));
}
/// b > 0
inline Interval operator/(const Interval& a, const Interval& b) {
  if (a.lo == 0.0 && a.hi == 0.0) return {};
  const double p = a.lo / b.lo, q = a.lo / b.hi, r = a.hi / b.lo, s = a.hi / b.hi;
  return Interval::widened(std::min({p, q, r, s}), std::max({p, q, r, s}));
}
inline Interval square_root(const Interval& a) {
  return Interval::widened(std::sqrt(std::max(a.lo, 0.0)), std::sqrt(std::max(a.hi, 0.0)));
}
inline Interval two_pi() {
  return Interval::widened(2.0 * std::numbers::pi, 2.0 * std::numbers::pi);
}
/// The library's sine and cosine are accurate to an ulp; 4e-16 more than covers it. The slope is at most 1.
inline Interval interval_cos(const Interval& x) {
  const double centre = 0.5 * (x.lo + x.hi), reach = (x.hi - x.lo) + 4e-16, c = std::cos(centre);
  return {std::max(-1.0, c - reach), std::min(1.0, c + reach)};
}
inline Interval interval_sin(const Interval& x) {
  const double centre = 0.5 * (x.lo + x.hi), reach = (x.hi - x.lo) + 4e-16, s = std::sin(centre);
  return {std::max(-1.0, s - reach), std::min(1.0, s + reach)};
}

/// The library's exponential is accurate to an ulp; two more on either side cover it.
inline Interval interval_exp(const Interval& x) {
  constexpr double ulps = 4.0 * std::numeric_limits<double>::epsilon(), least = std::numeric_limits<double>::min();
  return {std::max(0.0, std::exp(x.lo) * (1.0 - ulps) - least), std::exp(x.hi) * (1.0 + ulps) + least};
}

}  // namespace accdec
