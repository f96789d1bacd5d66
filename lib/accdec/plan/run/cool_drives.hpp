#pragma once

#include <functional>

#include <accdec/files.hpp>
#include <accdec/plan/command/choose_feeds.hpp>

namespace accdec {

enum class Cooled { already, slowed, failed };

/// Lowers feeds of a plan until no drive is warmer over the program than its rating. It lowers all by one factor, or
/// step by step those that cool most for the time that they cost. The faster plan is the result.
/// @param plan  holds all other limits; changed only if a slower plan does, too
/// @param check  simulates a plan whose feeds were changed
/// @param trials_max  plans that are simulated
Cooled cool_drives(ScheduledPlan& plan, const Filter& filter, double sample_period, const Machine& machine,
                   const std::function<void(ScheduledPlan&)>& check, const Deadline& deadline,
                   double trials_max = 400.0);

}  // namespace accdec
