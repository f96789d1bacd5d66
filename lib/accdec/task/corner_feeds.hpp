#pragma once

#include <functional>
#include <optional>
#include <vector>

#include <accdec/corner.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/task/blend_check.hpp>
#include <accdec/task/corner_feed.hpp>

// Internal to the room: corners that a control passes at a part of the feed, by formula.

namespace accdec {

/// Corners at parts of the feed with one filter.
class CornerFeeds {
 public:
  CornerFeeds(const Filter& filter, const FilterBehind& behind, const Task& task, const BlendLimits& limits)
      : behind_(behind),
        task_(task),
        limits_(limits),
        step_(task.settings->corner_feed_step),
        lead_(corner_feed_lead(filter.order(), behind.longer())) {}

  /// The largest part at which a corner holds its limits and loses less than `samples`; none: there is none.
  std::optional<double> largest(const TaskCorner& corner, double samples, const std::function<bool()>& stop) const {
    for (int multiple = most(corner); multiple > 0; --multiple) {
      const double part = multiple * step_;
      if (lost(part) >= samples || (stop && stop())) return std::nullopt;
      if (holds(corner, part)) return part;
    }
    return std::nullopt;
  }
  double lost(double part) const { return corner_feed_loss(part, lead_); }
  /// The least that a corner loses, by its error alone.
  double least_lost(const TaskCorner& corner) const { return lost(most(corner) * step_); }

 private:
  /// The largest multiple of the step at which the error may hold: it is in proportion to the feed.
  int most(const TaskCorner& corner) const {
    const int multiple = corner_feed_multiples(step_);
    if (!corner.error_max) return multiple;
    const double error = corner_error(behind_, corner.geometry(), 0, task_.sample_period);
    const double allowed = *corner.error_max * (1.0 + 1e-6) + position_floor;
    return multiple * step_ * error > allowed ? static_cast<int>(allowed / (step_ * error)) : multiple;
  }

  /// The motion has settled between the steps of the command, so that each is a corner by itself.
  bool holds(const TaskCorner& corner, double part) const {
    const Corner& g = corner.geometry();
    TaskCorner slow = corner;
    slow.set_feeds(part * g.feed_in, part * g.feed_out);
    return BlendCheck(behind_, slow, task_, limits_).holds(0) &&
           step_holds(g.direction_in, g.feed_in, part * g.feed_in) &&
           step_holds(g.direction_out, part * g.feed_out, g.feed_out);
  }
  bool step_holds(const Eigen::VectorXd& along, double before, double after) const {
    const std::vector<double> direction(along.begin(), along.end());
    const TaskCorner straight("", DirectedLegs{direction, direction}, before, after,
                              static_cast<int>(direction.size()));
    return BlendCheck(behind_, straight, task_, limits_).holds(0);
  }

  const FilterBehind& behind_;
  const Task& task_;
  const BlendLimits& limits_;
  double step_;
  int lead_;
};

}  // namespace accdec
