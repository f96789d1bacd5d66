#pragma once

#include <accdec/program/plan/feed_caps.hpp>
#include <accdec/program/plan/program_plan.hpp>

namespace accdec {

/// A plan with the path it is for: the feeds are those of the path's blocks.
struct ScheduledPlan {
  Toolpath path;
  ProgramPlan plan;
};

/// Chooses the feeds of a program for one filter: at every joint a speed and a delay, inside the blocks steps of the
/// feed, so that the limits hold. Programmed feeds are upper bounds. What is returned has been simulated; where that
/// found a limit or a tolerance broken, joints are passed slower and limits are used less around it, round by round.
ScheduledPlan schedule_feeds(const Toolpath& path, const Filter& filter, double sample_period, const Machine& machine,
                             int rounds_max = 40);

}  // namespace accdec
