#pragma once

#include <optional>
#include <vector>

#include <accdec/certificate/interval.hpp>
#include <accdec/task/task.hpp>

namespace accdec {

/// Safe bounds low <= B_k <= high on cumulative responses, k = 0 .. N + 1.
struct CheckedTube {
  std::vector<double> low, high;
  Interval at(int k) const {
    if (k <= 0) return Interval(0.0);
    if (k + 1 >= static_cast<int>(low.size())) return Interval(1.0);
    return {low[static_cast<std::size_t>(k)], high[static_cast<std::size_t>(k)]};
  }
};

/// What a split of the proof's tree says: B_sample <= level, or >= level.
struct CheckedCut {
  int sample;
  bool upper;
  double level;
};

/// Start or stop of one axis, with what its limits ask of s = its speed: F/s, P/s^2, P_regen/s^2. A limit that is not
/// there is infinite.
struct CheckedPlant {
  Interval inertia, drag;  ///< m/T, c
  Interval force, power, regeneration;
  bool stop = false;
};

/// Bounds that every filter of order N or less within the cuts obeys, by what one tap can add to the response: its
/// largest value after the largest response before it, its smallest before the smallest after it. None if no filter is
/// left.
/// @param jerk_max  bound on the difference of neighbouring taps, those before the first and after the last being 0
std::optional<CheckedTube> checked_tube(const std::vector<CheckedPlant>& plants, double tap_max, double jerk_max,
                                        int order, const std::vector<CheckedCut>& cuts);

}  // namespace accdec
