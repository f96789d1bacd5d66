#pragma once

#include <string>
#include <vector>

#include <accdec/program/plan/design_program_filter.hpp>
#include <accdec/program/write/program_report.hpp>

namespace accdec {

/// What `accdec verify` says of a program's result.
struct ProgramResultCheck {
  bool accepted = false;
  std::vector<std::string> reasons;  ///< why not
  std::string shown;                 ///< what was simulated, in words
  ProgramResult found;               ///< what follows from the commands, as it should be recorded
};

/// Simulates the commands that a result records (its path, feeds, delays and filters) anew, by direct_motion, and
/// compares: the error of every joint with its tolerance and with what is recorded; bound, value, use and place of
/// every axis limit over every sample; vibration bounds; the filter with the task's. Relative 1e-7, or 1e-9 m, for two
/// summations round differently. All else that follows from the commands is in `found`: the bounds on the time, counts
/// of the program and times of other plans do not.
/// @param task  the result's own
ProgramResultCheck verify_program_result(const ProgramResult& result, const Task& task);

}  // namespace accdec
