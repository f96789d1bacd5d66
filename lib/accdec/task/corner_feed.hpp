#pragma once

#include <algorithm>
#include <cmath>

#include <accdec/task.hpp>

// Corners that are passed at a part of the feed: DelayKind::corner_feed.
//
// A block before the corner lowers the command to part f of leg 1's feed, `lead` samples before the corner. Leg 2
// begins at part f of its own feed, with d = 0, and its feed is commanded again `lead` samples later. The lead is so
// long that the motion has settled at each feed before the next step. The corner is therefore that of feeds f v1 and f
// v2, and its error f times as large. Two steps of the speed along a straight line come with it.
//
// A sample at part f covers f of the way that it covers at feed. The corner takes (1 - f) T longer for each of its
// 2 `lead` slow samples than it would with d = 0 at feed. That time counts as a delay's.

namespace accdec {

/// Whether the control may pass a corner of the task at a part of the feed. Free taps never do.
inline bool may_pass_slower(const Task& task) {
  if (!task.settings || !task.settings->names(DelayKind::corner_feed)) return false;
  const auto open = [](const TaskCorner& corner) { return corner.delay.value_or(0) == 0; };
  return (task.filter || task.settings->names_family()) && std::ranges::any_of(task.corners, open);
}

/// Samples from a step of the command until the motion is steady, and one more for its jerk.
/// @param order     of the filter
/// @param response  of the machine, its order (machine/response.hpp)
inline int corner_feed_lead(int order, int response) {
  return order + response + 2;
}

/// Samples that a corner loses at this part of the feed.
inline double corner_feed_loss(double part, int lead) {
  return 2.0 * lead * (1.0 - part);
}

/// The largest multiple of a step that is below 1. @param step  > 0
inline int corner_feed_multiples(double step) {
  return static_cast<int>(std::ceil(1.0 / step * (1.0 - 1e-12))) - 1;
}

/// The largest multiple of a step up to a part of the feed; 0 if there is none. @param step  > 0
inline double corner_feed_part(double part, double step) {
  return std::floor(part / step) * step;
}

}  // namespace accdec
