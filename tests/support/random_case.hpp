#pragma once

#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include <accdec/corner.hpp>
#include <accdec/filter.hpp>

namespace accdec::test {

using Random = std::mt19937_64;

inline double uniform(Random& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}
inline double log_uniform(Random& random, double low, double high) {
  return std::exp(uniform(random, std::log(low), std::log(high)));
}
inline int integer(Random& random, int low, int high) {
  return std::uniform_int_distribution<int>(low, high)(random);
}

/// Random filters of order 0 to order_max, of every kind that a user might have. They are standard shapes, rough random
/// taps, taps over a huge dynamic range, one-sided decays, combs, and filters with zero taps at either end.
inline Filter random_filter(Random& random, int order_max) {
  const int order = integer(random, 0, order_max);
  std::vector<double> taps(static_cast<std::size_t>(order) + 1);
  switch (integer(random, 0, 9)) {
    case 0: return boxcar(order);
    case 1: return trapezoid(order, integer(random, 0, order / 2));
    case 2: return order < 2 ? boxcar(order) : s_curve(order);
    case 3: return order < 2 ? boxcar(order) : blackman_sinc(order, uniform(random, 0.1, 2.0) / order);
    case 4:
      for (double& b : taps) b = uniform(random, 0.0, 1.0);
      break;
    case 5:
      for (double& b : taps) b = log_uniform(random, 1e-9, 1.0);
      break;
    case 6: {
      const double decay = uniform(random, 0.5, 1.2);
      for (std::size_t i = 0; i < taps.size(); ++i) taps[i] = std::pow(decay, static_cast<double>(i));
      break;
    }
    case 7:  // comb: mostly zeros inside
      for (double& b : taps) b = integer(random, 0, 4) == 0 ? uniform(random, 0.0, 1.0) : 0.0;
      taps[static_cast<std::size_t>(integer(random, 0, order))] = 1.0;
      break;
    case 8:
      for (double& b : taps) b = log_uniform(random, 1e-60, 1.0);
      break;
    default: {  // zero taps at both ends
      const int first = integer(random, 0, order), last = integer(random, first, order);
      for (int i = first; i <= last; ++i) taps[static_cast<std::size_t>(i)] = uniform(random, 0.01, 1.0);
    }
  }
  return Filter(std::move(taps));
}

/// Two random legs in `axes` axes with the given interior angle, rad (axes >= 2), feeds 6 .. 60 m/min.
inline Corner random_corner_in_space(Random& random, int axes, double angle) {
  std::normal_distribution<double> normal;
  Eigen::VectorXd u(axes), w(axes);
  for (int i = 0; i < axes; ++i) u[i] = normal(random), w[i] = normal(random);
  u.normalize();
  w = (w - w.dot(u) * u).normalized();
  return make_corner(u, -std::cos(angle) * u + std::sin(angle) * w, uniform(random, 0.1, 1.0),
                     uniform(random, 0.1, 1.0));
}

}  // namespace accdec::test
