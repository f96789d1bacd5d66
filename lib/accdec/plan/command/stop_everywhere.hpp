#pragma once

#include <accdec/plan/command/choose_feeds.hpp>

namespace accdec {

/// The plan for want of another: the motion rests at the end of every block, for longer than the filter acts. Feeds are
/// at most those from which the filter surely starts and stops. Blocks shorter than the filter, whose start and stop
/// overlap, have half of that. One pass over the program; it has to be checked like any other plan.
/// @param machine  as many axes as the path, or without axes
ScheduledPlan stop_everywhere(const Toolpath& path, const Filter& filter, double sample_period, const Machine& machine);

/// Samples that this plan takes, without simulating it.
double stop_everywhere_samples(const Toolpath& path, const Filter& filter, double sample_period,
                               const Machine& machine);

}  // namespace accdec
