#pragma once

#include <functional>
#include <string>

namespace accdec {
struct Task;
}

namespace accdec::explore {

/// The page of a program begins with this: what start_json has, for the corner that turns most, and `program`. That has
/// the motion of every plan that holds all limits, the fastest first, the time lost by classes of corners, and the
/// corners as tables of a task.
/// @param task  of the program: without corners
/// @param free_seconds  for plan free; 0: without it
/// @param tell  called with what a user should know, a line each
/// @throws InputError, ReadError, std::invalid_argument as `accdec program`; std::runtime_error if no plan holds
std::string program_start_json(const std::string& file, const Task& task, double free_seconds,
                               const std::function<void(const std::string&)>& tell);

}  // namespace accdec::explore
