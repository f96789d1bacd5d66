#pragma once

#include <cstddef>
#include <optional>

#include <accdec/exact/limit_model.hpp>
#include <accdec/machine/response.hpp>

namespace accdec::exact {

/// One corner's contour with one filter, in samples of its faster leg. p is what is left of leg 1, q what is gone of
/// leg
/// 2. Inside the wedge of both legs, the nearer one is min(p, q) sin(theta) away. As p falls and q rises, the polyline
/// keeps the tolerance exactly if at some time both are at most that over sin(theta). Keeps the reference to the
/// filter.
class ContourPath {
 public:
  ContourPath(const LimitModel& model, const Filter& filter, std::size_t corner);

  /// The time in the range at which the larger of both distances is least.
  double crossing(int delay, const CornerBox& range) const;
  /// By how much the larger of both distances exceeds its bound at a time.
  double missed(int delay, double time) const;

 private:
  double left(double time) const;
  double gone(double time) const;

  FilterBehind behind_;
  const Filter& filter_;  // of the motion
  double in_, out_, bound_;
};

/// A filter's corner whose contour tolerance is missed most, the time of its crossing, and by how much.
struct MissedContour {
  int corner = 0;
  double at = 0.0, by = 0.0;
};
/// It takes the longest delays of the box. None: every tolerance holds, or no time can be split any more.
std::optional<MissedContour> missed_contour(const LimitModel& model, const Filter& filter, const Box& box);
/// Whether it holds with a delay, at some time of the box. True where the box does not bound it.
bool contour_holds(const LimitModel& model, const Filter& filter, const Box& box, std::size_t corner, int delay);
/// The box with every corner's time at this filter's crossing.
Box at_crossings(const LimitModel& model, const Filter& filter, Box box);

}  // namespace accdec::exact
