#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include <accdec/corner.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/task.hpp>
#include <accdec/task/blend_check.hpp>
#include <accdec/task/corner_feeds.hpp>
#include <accdec/task/delay_kinds.hpp>
#include <accdec/task/objective.hpp>

// Internal to the room: what delays of a controller's kinds cost at least with one filter.

namespace accdec {

/// In-position of one filter, as the control measures it.
class InPosition {
 public:
  /// @param behind  of the designed filter
  InPosition(const FilterBehind& behind, const Task& task)
      : behind_(behind),
        settings_(*task.settings),
        actual_(task.settings->in_position_actual && !behind.ideal()),
        period_(task.sample_period),
        latency_(static_cast<int>(std::lround(task.settings->in_position_latency / period_))) {}

  int latency() const { return latency_; }  ///< samples
  /// Samples of leg 1 from its command's end until nothing is left of it.
  int longest() const {
    int most = behind_.command().last_nonzero_tap();
    for (const Filter& motion : actual_ ? behind_.servo() : std::span<const Filter>())
      most = std::max(most, motion.last_nonzero_tap());
    return most;
  }
  /// The remaining way of leg 1 so many samples after its command's end, m: with a smaller width the next block waits
  /// longer. Behind an overshooting response it is the least so far, as the control looks for the first sample.
  double way_left(const TaskCorner& corner, int samples) const {
    double least = way_at(corner, samples);
    for (int before = samples - 1; actual_ && behind_.gain() > 1.0 && before >= 0; --before)
      least = std::min(least, way_at(corner, before));
    return least;
  }

 private:
  double way_at(const TaskCorner& corner, int samples) const {
    const Corner& g = corner.geometry();
    if (!actual_ || !behind_.differs())
      return watched_speed(settings_, g) * period_ *
             (actual_ ? behind_.motion() : behind_.command()).remaining_moment(samples);
    Eigen::VectorXd ways = g.direction_in;
    for (Eigen::Index a = 0; a < g.axes(); ++a)
      ways[a] *= behind_.motion(static_cast<std::size_t>(a)).remaining_moment(samples);
    return g.feed_in * period_ * (settings_.in_position_by_axis ? ways.cwiseAbs().maxCoeff() : ways.norm());
  }

  const FilterBehind& behind_;
  const ControllerSettings& settings_;
  bool actual_;
  double period_;
  int latency_;
};

/// Bounds by the corners' errors alone: most filters are too slow by them, before any limit is looked at.
class LeastDelays {
 public:
  /// References are kept. @param behind  the filter behind the machine's response
  LeastDelays(const Filter& filter, const FilterBehind& behind, const Task& task, const BlendLimits& limits)
      : task_(task),
        order_(filter.order()),
        apart_(exact_stop_delay(behind.command())),
        in_position_(behind, task),
        corner_feeds_(filter, behind, task, limits) {
    const DelayFinder smallest(behind.motion());
    for (const TaskCorner& corner : task.corners) {
      least_.push_back(corner.delay.value_or(0));
      if (corner.delay || !corner.error_max || behind.differs()) continue;
      const double allowed = std::max(*corner.error_max * formula_slack, position_floor) * (1.0 + 1e-9);
      least_.back() = delay_for_error(smallest, corner.geometry(), task.sample_period, allowed);
    }
  }

  const InPosition& in_position() const { return in_position_; }
  const CornerFeeds& corner_feeds() const { return corner_feeds_; }
  /// The delay of an exact stop.
  int apart() const { return apart_; }
  /// A corner's error is too large with shorter delays; given delays as they are.
  int of(std::size_t corner) const { return least_[corner]; }

  /// Samples of the objective that the filter and delays of the task's kinds cost at least.
  double cost() const {
    const LinearCost linear = cost_of(task_);
    double sum = linear.filter * (order_ + 1);
    for (std::size_t j = 0; j < least_.size(); ++j) sum += linear.delay[j] * samples(j);
    return sum;
  }

 private:
  double samples(std::size_t j) const {
    const auto names = [&](DelayKind kind) { return task_.settings->names(kind); };
    const std::optional<int> given = task_.corners[j].delay;
    double least = unlimited;
    if (names(DelayKind::continuous) && least_[j] == 0) return 0.0;
    if (names(DelayKind::dwell) || names(DelayKind::timed_axis)) least = least_[j];
    if (names(DelayKind::exact_stop)) least = std::min<double>(least, given.value_or(apart_));
    if (names(DelayKind::in_position) && !given)
      least = std::min<double>(least, std::max(least_[j], in_position_.latency()));
    if (names(DelayKind::corner_feed) && given.value_or(0) == 0)
      least = std::min(least, corner_feeds_.least_lost(task_.corners[j]));
    return least;
  }

  const Task& task_;
  int order_, apart_;
  InPosition in_position_;
  CornerFeeds corner_feeds_;
  std::vector<int> least_;
};

}  // namespace accdec
