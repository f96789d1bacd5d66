#pragma once

#include <functional>
#include <string>

#include <accdec/filter.hpp>
#include <accdec/program.hpp>
#include <accdec/simulate/direct.hpp>
#include <accdec/task.hpp>

// Internal to the room: a part of verify_program_result.

namespace accdec {

/// Each delay of a result with settings is one that the task's control has, and the in-position width gives it.
/// @param filter  behind the control's own smoothing  @param motion  of the command behind it
/// @param wrong   takes what does not hold
void check_control_delays(const ProgramResult& result, const Task& task, const Filter& filter,
                          const DirectMotion& motion, const std::function<void(std::string)>& wrong);

}  // namespace accdec
