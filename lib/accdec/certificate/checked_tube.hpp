#pragma once

#include <optional>
#include <vector>

#include <accdec/certificate/interval.hpp>
#include <accdec/task.hpp>

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

/// A split of the proof's tree: B_sample <= level, or >= level.
struct CheckedCut {
  int sample;
  bool upper;
  double level;
};

/// Start or stop of one axis, with its limits scaled by its speed s: F/s, P/s^2, P_regen/s^2. A missing limit is
/// infinite.
struct CheckedPlant {
  Interval inertia, drag;  ///< m/T, c
  Interval force, power, regeneration;
  bool stop = false;
};

/// Bounds for every filter of order N or less within the cuts. They follow from how much one tap can add to the
/// response. The largest value follows from the largest response before it, the smallest from the smallest response
/// after it. None if no filter is left.
/// @param jerk_max  bound on the difference of neighbouring taps, those before the first and after the last being 0
std::optional<CheckedTube> checked_tube(const std::vector<CheckedPlant>& plants, double tap_max, double jerk_max,
                                        int order, const std::vector<CheckedCut>& cuts);

}  // namespace accdec
