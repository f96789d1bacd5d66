#pragma once

#include <algorithm>
#include <cmath>

#include <accdec/filter.hpp>
#include <accdec/task.hpp>

namespace accdec {

/// Whether the taps are symmetric, to 1e-9, or the task does not ask for it.
inline bool symmetric_as_asked(const Task& task, const Filter& filter) {
  const auto taps = filter.taps();
  const auto alike = [](double a, double b) { return std::abs(a - b) <= 1e-9; };
  return !task.design.symmetric || std::equal(taps.begin(), taps.end(), taps.rbegin(), alike);
}

}  // namespace accdec
