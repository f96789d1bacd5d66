#pragma once

#include <string>

#include <accdec/files.hpp>
#include <accdec/program.hpp>

namespace accdec {

/// @param path  as it was read
ProgramSubject subject_of(std::string program, const Toolpath& path, const Task& task);

/// A result before its plan is made. @throws std::invalid_argument for keys of the task that are not for programs
ProgramResult before_planning(const PlanningProblem& problem);

/// "Ctrl-C" or "the time limit".
const char* ended_by(const Deadline& deadline);

/// If the time ended before a plan held, the message says so.
void say_what_ended(ProgramResult& result, const Deadline& deadline);

}  // namespace accdec
