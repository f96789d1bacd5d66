#pragma once

#include <cstddef>
#include <limits>

#include <accdec/exact/limit_model.hpp>
#include <accdec/machine/response.hpp>

namespace accdec::exact {

/// One corner's error with one filter, in samples of its faster leg. Keeps the references.
class CornerError {
 public:
  CornerError(const LimitModel& model, const Filter& filter, std::size_t corner);

  double at(int delay, int sample) const;
  /// Least amount by which the error exceeds its bound, as the linear program of the ranges sees it.
  double relaxed(const CornerBox& ranges) const;
  /// Whether it is within its bound at a sample of the ranges.
  bool holds(int delay, const CornerBox& ranges, int order) const;
  /// The sample at which the filter comes closest to the corner.
  int closest_sample(int delay) const;

 private:
  FilterBehind behind_;
  const Filter& filter_;  // of the motion
  double cosine_, in_, out_, bound_;
};

/// A split of a corner's ranges, and by how much the filter misses its error in the better of the two parts.
struct ErrorSplit {
  proof::Split split;
  double gain = -std::numeric_limits<double>::infinity();
};
/// Takes the split of these ranges that the filter misses by most, if that is more than `chosen`.
/// @param delays_too  else the delay is split only where the sample is single
void consider_splits(const CornerError& error, std::size_t corner, const CornerBox& ranges, bool delays_too,
                     ErrorSplit& chosen);

}  // namespace accdec::exact
