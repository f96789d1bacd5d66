#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <unordered_map>

#include <accdec/filter.hpp>

namespace accdec {

/// Internal to the room: cascades that are too slow because one was whose last length, or time between impulses, is
/// shorter and that is the same otherwise. A longer one spreads the taps around their middle. So both legs are at least
/// as far from the corner, at samples if the mean delays differ by whole samples, and between samples in any case
///. Searches by rising order ask again and again about the same cascades with a longer end.
class SlowMembers {
 public:
  /// @param lengths  of the averages, falling; of more than 2^21 samples, or of three with a shaper, nothing is known
  bool covers(std::span<const int> lengths, const FilterSpec& spec) const {
    const auto found = from_.find(key_of(lengths, spec));
    if (found == from_.end()) return false;
    return last_of(lengths, spec) >= std::min(found->second[class_of(spec)], found->second[between_samples]);
  }
  /// This one is too slow. @param between  also if positions between samples count
  void remember(std::span<const int> lengths, const FilterSpec& spec, bool between) {
    if (!known(lengths, spec)) return;
    double& from = from_.try_emplace(key_of(lengths, spec), Froms{never, never, never})
                       .first->second[between ? between_samples : class_of(spec)];
    from = std::min(from, last_of(lengths, spec));
  }

 private:
  static constexpr std::size_t between_samples = 2;
  static constexpr double never = 1e300;
  using Froms = std::array<double, 3>;  ///< of even and of odd orders, and between samples

  static bool known(std::span<const int> lengths, const FilterSpec& spec) {
    return lengths.front() < 1 << 21 && (spec.pairs == 0 || lengths.size() < 3);
  }
  static std::size_t class_of(const FilterSpec& spec) {
    return spec.pairs == 0 || spec.whole_pairs() ? static_cast<std::size_t>(spec.full_order() % 2) : between_samples;
  }
  static double last_of(std::span<const int> lengths, const FilterSpec& spec) {
    return spec.pairs == 0 ? static_cast<double>(lengths.back()) : spec.pair_delay;
  }
  static std::uint64_t key_of(std::span<const int> lengths, const FilterSpec& spec) {
    std::uint64_t key = lengths.size();
    for (const int length : spec.pairs == 0 ? lengths.first(lengths.size() - 1) : lengths)
      key = key << 21 | static_cast<std::uint64_t>(length);
    return key;
  }

  std::unordered_map<std::uint64_t, Froms> from_;
};

}  // namespace accdec
