#pragma once

#include <cstddef>
#include <limits>

#include <accdec/exact/limit_model.hpp>

namespace accdec::exact {

/// One corner's error with one filter, in samples of its faster leg. Keeps the references.
class CornerError {
 public:
  CornerError(const LimitModel& model, const Filter& filter, std::size_t corner);

  double at(int delay, int sample) const;
  /// By how much the error is above its bound at least, as the linear program of the ranges sees it.
  double relaxed(const CornerBox& ranges) const;
  /// Whether it is within its bound at a sample of the ranges.
  bool holds(int delay, const CornerBox& ranges, int order) const;

 private:
  const Filter& filter_;
  double cosine_, in_, out_, bound_;
};

/// A split of a corner's ranges and by how much the filter misses its error in the better of both parts.
struct ErrorSplit {
  proof::Split split;
  double gain = -std::numeric_limits<double>::infinity();
};
/// Takes the split of these ranges that the filter misses by most, if that is more than `chosen`.
/// @param delays_too  else the delay is only split where the sample is single
void consider_splits(const CornerError& error, std::size_t corner, const CornerBox& ranges, bool delays_too,
                     ErrorSplit& chosen);

}  // namespace accdec::exact
