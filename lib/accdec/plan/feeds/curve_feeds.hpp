#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <accdec/machine/response.hpp>
#include <accdec/simulate.hpp>

namespace accdec {

/// Blocks within a leg, usually chords, that lie within one filter length.
struct Curve {
  std::size_t first = 0, last = 0;
};

/// The curves of a program on which delays or lower feeds are a choice, and the feeds at which they need no delay.
struct CurveFeeds {
  std::vector<Curve> curves;     ///< ascending
  std::vector<double> duration;  ///< s, of every block: at the feed below, at least the programmed one
};

/// The error of a joint in a curve at constant speed v is its distance from the sum of points v T apart, weighted with
/// the taps. On an arc of radius R it is about v^2 s^2 T^2/(2 R) with the second moment s^2 of the taps. The feed of a
/// block is the largest, up to the programmed one, that keeps the tolerance and the contour at both its joints, found
/// by bisection. If nothing is tolerated (G61), the sagitta stands for the tolerance. Blocks longer than the filter
/// keep their feeds: their joints are alone, and a delay there costs less.
/// @param delays, planned  of a plan at the programmed feeds, whose durations s the path holds: what is delayed or was
/// slowed there belongs to curves
/// @param joints_max       with more joints to look at nothing is returned
CurveFeeds curve_feeds(const Toolpath& path, const FilterBehind& behind, double sample_period,
                       std::span<const int> delays, std::span<const double> planned, std::size_t joints_max);

/// Time in s that a plan spends on a curve: on its blocks and their neighbours, and at rest in their joints.
double curve_time(const Curve& curve, std::span<const double> duration, std::span<const int> delays,
                  double sample_period);

}  // namespace accdec
