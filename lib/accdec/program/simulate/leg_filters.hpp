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

/// The same shape in `count` >= 1 taps: the step response, linear between its samples, over count instead of N + 1
/// samples.
Filter stretched(const Filter& filter, int count);

}  // namespace accdec
