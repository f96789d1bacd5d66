#pragma once

#include <algorithm>
#include <cmath>

namespace accdec {

/// The chance that a sum of `count` independent exponential variables of mean 1 is larger than x: half of chi squared
/// with twice as many degrees of freedom. It is exp(-x) sum_{k < count} x^k/k!.
inline double gamma_tail(int count, double x) {
  if (!(x > 0.0)) return 1.0;
  double sum = 0.0;
  for (int k = 0; k < count; ++k) sum += std::exp(k * std::log(x) - x - std::lgamma(k + 1.0));
  return std::min(1.0, sum);
}

}  // namespace accdec
