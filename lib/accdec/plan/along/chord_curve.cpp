#include <algorithm>
#include <cmath>

#include <accdec/plan/along/chord_curve.hpp>

namespace accdec {

ChordCurve::ChordCurve(const Toolpath& path, std::size_t first, std::size_t last)
    : n_(path.dimensions()),
      point_(path.point(first), path.point(last + 1) + n_),
      knot_{0.0},
      second_(point_.size(), 0.0) {
  for (std::size_t b = first; b <= last; ++b) knot_.push_back(knot_.back() + path.length(b));
  // The second derivatives of neighbours, by elimination from the first to the last.
  const std::size_t m = chords();
  const auto step = [&](std::size_t i) { return knot_[i + 1] - knot_[i]; };
  const auto slope = [&](std::size_t i, std::size_t a) {
    return (point_[(i + 1) * n_ + a] - point_[i * n_ + a]) / step(i);
  };
  std::vector<double> pivot(m, 0.0);
  for (std::size_t i = 1; i < m; ++i) {
    pivot[i] = 2.0 * (step(i - 1) + step(i)) + (i == 1 ? step(0) : 0.0) + (i + 1 == m ? step(m - 1) : 0.0);
    const double carried = i > 1 ? step(i - 1) / pivot[i - 1] : 0.0;
    pivot[i] -= carried * step(i - 1);
    for (std::size_t a = 0; a < n_; ++a)
      second_[i * n_ + a] = 6.0 * (slope(i, a) - slope(i - 1, a)) - carried * second_[(i - 1) * n_ + a];
  }
  for (std::size_t i = m; i-- > 1;) {
    for (std::size_t a = 0; a < n_; ++a) {
      double& value = second_[i * n_ + a];
      if (i + 1 < m) value -= step(i) * second_[(i + 1) * n_ + a];
      value /= pivot[i];
    }
  }
  for (std::size_t a = 0; a < n_; ++a) {
    second_[a] = second_[n_ + a];
    second_[m * n_ + a] = second_[(m - 1) * n_ + a];
  }
}

PathPlace ChordCurve::at(double u) const {
  const auto after = std::upper_bound(knot_.begin() + 1, knot_.end() - 1, u);
  const auto i = static_cast<std::size_t>(after - knot_.begin()) - 1;
  const double h = knot_[i + 1] - knot_[i], p = (u - knot_[i]) / h, q = 1.0 - p;
  PathPlace place;
  for (std::size_t a = 0; a < n_; ++a) {
    const double from = point_[i * n_ + a], to = point_[(i + 1) * n_ + a];
    const double left = second_[i * n_ + a], right = second_[(i + 1) * n_ + a];
    place.position[a] = q * from + p * to - h * h / 6.0 * p * q * ((1.0 + q) * left + (1.0 + p) * right);
    place.first[a] = (to - from) / h + h / 6.0 * ((1.0 - 3.0 * q * q) * left - (1.0 - 3.0 * p * p) * right);
    place.second[a] = q * left + p * right;
  }
  return place;
}

double ChordCurve::off_chords() const {
  double most = 0.0;
  for (std::size_t i = 0; i < chords(); ++i) {
    double left = 0.0, right = 0.0;
    for (std::size_t a = 0; a < n_; ++a) {
      left = std::hypot(left, second_[i * n_ + a]);
      right = std::hypot(right, second_[(i + 1) * n_ + a]);
    }
    const double h = knot_[i + 1] - knot_[i];
    most = std::max(most, h * h / 8.0 * std::max(left, right));
  }
  return most;
}

}  // namespace accdec
