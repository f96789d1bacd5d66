#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <accdec/filter.hpp>
#include <accdec/simulate.hpp>

namespace accdec {

/// A filter over the positions of a motion, sample by sample, that knows where on the path its oldest sample lies.
///
/// Positions are kept as whole numbers of a unit so small that sums over the filter are exact in 64 bits. It is about
/// 2^-61 of the largest coordinate times the number of taps, so an average is rounded no more than a double is.
class SampleSmoother {
 public:
  using Point = std::array<double, program_axis_count>;
  /// At rest at a point. @param filter  the reference is kept  @param largest  m, no coordinate is larger
  SampleSmoother(const Filter& filter, std::size_t dimensions, const Point& at, std::int64_t place, double largest);
  int taps() const { return taps_; }
  /// Takes a sample in and gives the filtered one.
  void next(const Point& raw, std::int64_t place, Point& out);
  /// As many samples at one place. @param rows  of every axis, replaced  @param oldest  places, see below; written
  void next_run(const std::array<double*, program_axis_count>& rows, std::int64_t count, std::int64_t place,
                std::int64_t* oldest);
  /// The place of the oldest sample inside; `newest` is the present one.
  std::int64_t oldest_place(std::int64_t newest) const { return taps_ == 1 ? newest : places_[slot_]; }

 private:
  std::int64_t units(double x) const;
  void advance(std::int64_t place);
  template <std::size_t axes>
  void take_run(const std::array<double*, program_axis_count>& rows, std::int64_t count, std::int64_t place,
                std::int64_t* oldest);
  double smoothed(std::size_t axis, double raw, std::int64_t& oldest);
  template <std::size_t axes>
  void take(const Point& raw, std::int64_t* row, Point& out);
  void convolve(const Point& raw, std::size_t newest, Point& out) const;

  const Filter& filter_;
  const int taps_;
  bool equal_ = true;  // taps
  const std::size_t n_;
  double unit_ = 0.0, per_unit_ = 0.0;  // m and 1/m, powers of two
  double share_ = 0.0;                  // m: a unit over the number of taps
  std::vector<std::int64_t> ring_;      // taps rows, in units
  std::vector<std::int64_t> places_;
  std::size_t slot_ = 0;
  std::array<std::uint64_t, program_axis_count> sum_{};  // signed sums, which may wrap
};

}  // namespace accdec
