#pragma once

#include <cstddef>
#include <numeric>
#include <random>
#include <utility>
#include <vector>

namespace accdec::batch {

/// Uniform in [0, 1) from the 53 high bits. It is the same on every platform, unlike the standard library's
/// distributions.
inline double uniform(std::mt19937_64& rng) {
  return static_cast<double>(rng() >> 11) * 0x1p-53;
}

/// 0 .. size - 1 in random order (Fisher-Yates). std::shuffle may differ from library to library.
inline void shuffle(std::vector<std::size_t>& order, std::mt19937_64& rng) {
  std::iota(order.begin(), order.end(), std::size_t{0});
  for (std::size_t i = order.size(); i > 1; --i)
    std::swap(order[i - 1], order[static_cast<std::size_t>(uniform(rng) * static_cast<double>(i))]);
}

/// A column of a Latin hypercube: numbers in [0, 1), one in each of `count` equal cells, in random order.
inline std::vector<double> latin_column(std::size_t count, std::mt19937_64& rng) {
  std::vector<std::size_t> cells(count);
  shuffle(cells, rng);
  std::vector<double> column;
  for (const std::size_t cell : cells)
    column.push_back((static_cast<double>(cell) + uniform(rng)) / static_cast<double>(count));
  return column;
}

}  // namespace accdec::batch
