#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace accdec {

/// The taps of one filter behind another. Checkers have this sum again.
inline std::vector<double> convolved(std::span<const double> a, std::span<const double> b) {
  std::vector<double> taps(a.size() + b.size() - 1, 0.0);
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = 0; j < b.size(); ++j) taps[i + j] += a[i] * b[j];
  }
  return taps;
}

}  // namespace accdec
