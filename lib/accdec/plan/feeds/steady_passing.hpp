#pragma once

#include <array>
#include <cstddef>

#include <accdec/machine/response.hpp>
#include <accdec/plan/feeds/feed_march.hpp>
#include <accdec/simulate.hpp>

namespace accdec {

/// How far the motion is from joints that are passed at constant speed.
class SteadyPassing {
 public:
  /// References are kept.
  SteadyPassing(const Toolpath& path, const FeedPath& feeds, const FilterBehind& behind, double sample_period);

  /// Distance across the path, m, of the motion from the joint at the end of block b. Axes that lag differently leave
  /// a straight path, too.
  /// @param v  m/s
  double error(std::size_t b, double v) const;

 private:
  using Way = std::array<double, program_axis_count>;
  void add_seen(const Filter& filter, std::size_t b, double step, std::size_t first, std::size_t last, Way& sum) const;

  const Toolpath& path_;
  const FeedPath& feeds_;
  const FilterBehind& behind_;
  double period_;
  double passing_;  // samples from the command in a joint to the motion there
};

}  // namespace accdec
