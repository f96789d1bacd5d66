#pragma once

#include <string>
#include <vector>

#include <accdec/result.hpp>
#include <accdec/task.hpp>

// Internal to the room: the time of today's filter by a search of its own, for checks of results.

namespace accdec {

/// Designs with settings are compared with today's filter; others only if they are compared with all families.
void check_savings_recorded(const DesignResult& result, std::vector<std::string>& reasons);

/// Whether `check_time_of_today` knows the delays of a task's control: one in-position width is of all corners, and a
/// corner feed has no delay.
bool knows_delays_of_today(const Task& task);

/// Whether a time is that of the task's [baseline]: every corner by itself takes the first delay of the control's that
/// holds in simulation. Tasks whose delays are not known pass.
/// @param recorded  s
void check_time_of_today(const Task& task, double recorded, std::vector<std::string>& reasons);

}  // namespace accdec
