#pragma once

#include <optional>

#include <accdec/files.hpp>
#include <accdec/plan/command/program_plan.hpp>
#include <accdec/plan/feeds/feed_caps.hpp>

namespace accdec {

/// A plan with the path it is for: the feeds are those of the path's blocks.
struct ScheduledPlan {
  Toolpath path;
  ProgramPlan plan;
};

/// Chooses the feeds of a program for one filter: at every joint a speed and a delay, inside the blocks steps of the
/// feed, so that the limits hold. Programmed feeds are upper bounds. The returned plan was simulated. Joints
/// around a broken limit or tolerance are passed slower, and limits are used less there, round by round.
/// @param deadline  ends the rounds: what is returned then may not hold
/// @param corner_feed_step  see FeedCaps
ScheduledPlan schedule_feeds(const Toolpath& path, const Filter& filter, double sample_period, const Machine& machine,
                             int rounds_max = 40, const Deadline& deadline = {}, double corner_feed_step = 0.0);

/// s, enough for a few rounds on a busy core: one plan of chosen feeds is not cut short by a time limit. A motion with
/// stops at all corners needs no planning, but it may last ten times as long.
double seconds_for_one_plan(const Toolpath& path);

/// The same with a stop at the end of every block. No joint breaks its tolerance, and no two blocks act on each other,
/// so that one round is often enough. None if that takes longer than the deadline.
std::optional<ScheduledPlan> schedule_stops(const Toolpath& path, const Filter& filter, double sample_period,
                                            const Machine& machine, const Deadline& deadline);

}  // namespace accdec
