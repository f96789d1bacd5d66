#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <accdec/motion/filter.hpp>
#include <accdec/program/read/toolpath.hpp>

namespace accdec {

/// The filters of a program: one for all blocks, or one for every leg. A *leg* is a maximal sequence of blocks joined
/// by smooth or straight joints; its command passes through its own filter, and the motion is the sum of all legs'
/// filtered commands. The filter changes only where legs meet: between chords of an arc a longer lag would tear a gap,
/// a shorter one make two chords overlap.
class LegFilters {
 public:
  LegFilters(Filter filter) : filters_{std::move(filter)} {}  // NOLINT: one filter is a set of filters
  /// @param of_block  index of the filter of every block; empty: the first for all
  LegFilters(std::vector<Filter> filters, std::vector<std::uint16_t> of_block)
      : filters_(std::move(filters)), of_block_(std::move(of_block)) {}

  std::span<const Filter> filters() const { return filters_; }
  std::size_t index(std::size_t block) const { return of_block_.empty() ? 0 : of_block_[block]; }
  const Filter& of(std::size_t block) const { return filters_[index(block)]; }
  bool single() const { return of_block_.empty(); }
  int order_max() const {
    int order = 0;
    for (const Filter& filter : filters_) order = std::max(order, filter.order());
    return order;
  }

 private:
  std::vector<Filter> filters_;
  std::vector<std::uint16_t> of_block_;
};

/// Whether a leg ends with block b.
inline bool ends_leg(const Toolpath& path, std::size_t b) {
  return path.joint[b] == Joint::corner || path.joint[b] == Joint::stop;
}

/// The same shape in `count` >= 1 taps: the step response, linear between its samples, over count instead of N + 1
/// samples.
Filter stretched(const Filter& filter, int count);

/// For every leg the length of the filter's shape with which the program takes least time.
///
/// The shortest that may be taken starts and stops every block of the leg within the axis limits of its direction. A
/// longer one costs time where legs stand still between them, but overlaps more with its neighbours where the limits
/// would not let shorter ones. The sum of all delays, each the smallest of its pair of filters as if its corner were
/// alone, is made least by dynamic programming over the legs; long programs get fewer lengths to choose from, beyond
/// some hundred thousand legs the shortest only. Lengths that break a vibration bound, or have more taps than the
/// task's design.order_max + 1, are not taken.
/// @param order_max  of the filters
LegFilters choose_leg_filters(const Toolpath& path, const Filter& filter, double sample_period, const Machine& machine,
                              int order_max);

}  // namespace accdec
