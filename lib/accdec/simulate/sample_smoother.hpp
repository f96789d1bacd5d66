#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <accdec/filter.hpp>
#include <accdec/simulate.hpp>

namespace accdec {

/// A filter over the positions of a motion, sample by sample, that knows where on the path its oldest sample lies.
class SampleSmoother {
 public:
  using Point = std::array<double, program_axis_count>;
  /// At rest at a point. @param filter  the reference is kept
  SampleSmoother(const Filter& filter, std::size_t dimensions, const Point& at, std::int64_t place);
  int taps() const { return taps_; }
  /// Takes a sample in and gives the filtered one.
  void next(const Point& raw, std::int64_t place, Point& out);
  /// The place of the oldest sample inside; `newest` is the present one.
  std::int64_t oldest_place(std::int64_t newest) const { return taps_ == 1 ? newest : places_[slot_]; }

 private:
  void average(Point& out);
  void convolve(const Point& raw, std::size_t newest, Point& out) const;

  const Filter& filter_;
  const int taps_;
  bool equal_ = true;  // taps
  const std::size_t n_;
  std::vector<double> ring_;  // taps rows
  std::vector<std::int64_t> places_;
  std::size_t slot_ = 0;
  std::array<long double, program_axis_count> sum_{};
};

}  // namespace accdec
