#pragma once

#include <functional>

#include <accdec/files.hpp>
#include <accdec/plan/command/choose_feeds.hpp>

namespace accdec {

/// Lengthens delays of corners and durations of blocks by whole samples. In the end all moves together leave no mode of
/// an axis with more than its bound at a stop or at the program's end. This turns what rang before a corner against
/// what follows it. If no such change is found, the moves before that stop are slowed. All that makes the program at
/// most a quarter longer.
/// @param plan  holds all other limits; changed only if what it becomes does, too
/// @param check  simulates a plan whose delays or durations were changed
/// @return whether the plan is as quiet as that; also true if no mode of an axis is bounded
bool quieten(ScheduledPlan& plan, const Filter& filter, double sample_period, const Machine& machine,
             const std::function<void(ScheduledPlan&)>& check, const Deadline& deadline);

}  // namespace accdec
