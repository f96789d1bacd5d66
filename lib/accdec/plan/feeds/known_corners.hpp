#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <accdec/simulate.hpp>

namespace accdec {

/// Keeps the answers for corners. Engraved letters and pockets have few different ones. A corner has the answer of an
/// earlier one only if all numbers that it depends on are exactly the same.
template <class Answer>
class KnownCorners {
 public:
  static constexpr std::size_t numbers = 2 * program_axis_count + 7;
  using Key = std::array<double, numbers>;  // so many at most

  /// @param corners  of the path
  explicit KnownCorners(std::size_t corners) : places_(std::clamp<std::size_t>(corners, 1, 4096)) {}

  /// @param key      of as many numbers in every call
  /// @param compute  the answer where it is not known
  template <class Compute>
  Answer get(std::span<const double> key, const Compute& compute) {
    if (known_.empty()) known_.resize(places_);
    std::uint64_t hash = 0;
    for (const double x : key) {
      hash = (hash ^ std::bit_cast<std::uint64_t>(x)) * 0x9E3779B97F4A7C15;
      hash ^= hash >> 29;
    }
    Known& known = known_[hash % places_];
    const bool same = std::equal(key.begin(), key.end(), known.key.begin(), [](double a, double b) {
      return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
    });
    if (known.filled && same) return known.answer;
    known.answer = compute();
    std::copy(key.begin(), key.end(), known.key.begin());
    known.filled = true;
    return known.answer;
  }

 private:
  struct Known {
    bool filled = false;
    Key key{};
    Answer answer{};
  };
  std::size_t places_;
  std::vector<Known> known_;
};

}  // namespace accdec
