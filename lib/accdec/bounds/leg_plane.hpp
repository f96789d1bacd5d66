#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include <accdec/simulate.hpp>

namespace accdec {

/// A vector with one entry for every axis of a program.
using AxisVector = std::array<double, program_axis_count>;

inline double dot(const AxisVector& a, const AxisVector& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}
inline AxisVector combined(double x, const AxisVector& a, double y, const AxisVector& b) {
  AxisVector sum{};
  for (std::size_t i = 0; i < a.size(); ++i) sum[i] = x * a[i] + y * b[i];
  return sum;
}
inline double norm(const AxisVector& v) {
  return std::sqrt(dot(v, v));
}

/// The plane of two unit vectors, as two orthogonal unit vectors; the second is zero where there is only one axis.
class LegPlane {
 public:
  LegPlane() = default;
  /// @param in  zero: any plane through `out` and one of the axes
  LegPlane(const AxisVector& in, const AxisVector& out, const std::vector<std::size_t>& axes) : first_(out) {
    AxisVector other = combined(1.0, in, -dot(in, first_), first_);
    for (std::size_t i = 0; i < axes.size() && dot(other, other) < 1e-12; ++i) {
      other = {};
      other[axes[i]] = 1.0;
      other = combined(1.0, other, -dot(other, first_), first_);
    }
    const double length2 = dot(other, other);
    if (length2 >= 1e-12) second_ = combined(1.0 / std::sqrt(length2), other, 0.0, other);
  }
  AxisVector at_angle(double angle) const { return combined(std::cos(angle), first_, std::sin(angle), second_); }
  double angle_of(const AxisVector& v) const { return std::atan2(dot(v, second_), dot(v, first_)); }

 private:
  AxisVector first_{}, second_{};
};

}  // namespace accdec
