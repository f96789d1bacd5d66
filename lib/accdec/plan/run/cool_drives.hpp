#pragma once

#include <functional>

#include <accdec/files.hpp>
#include <accdec/plan/command/choose_feeds.hpp>

namespace accdec {

/// The largest root mean square of an axis' force over its rating; 0 without ratings.
double warmest_drive(const ScheduledPlan& plan, const Filter& filter, double sample_period, const Machine& machine);

/// Lowers all feeds of a plan by one factor, until no drive is warmer over the program than its rating.
/// @param plan  holds all other limits; changed only if a slower plan does, too
/// @param check  simulates a plan whose feeds were changed
/// @return whether it was slowed
bool cool_drives(ScheduledPlan& plan, const Filter& filter, double sample_period, const Machine& machine,
                 const std::function<void(ScheduledPlan&)>& check, const Deadline& deadline);

}  // namespace accdec
