#pragma once

#include <string>
#include <vector>

#include <accdec/program/plan/design_program.hpp>
#include <accdec/program/write/program_report.hpp>

namespace accdec {

/// What `accdec verify` says of a program's result.
struct ProgramResultCheck {
  bool accepted = false;
  std::vector<std::string> reasons;  ///< why not
  std::string shown;                 ///< what was simulated, in words
};

/// Simulates the commands that a result records (its path, feeds, delays and filters) anew, by direct_motion, and
/// compares: samples and cycle time, the error of every joint with its tolerance and with what is recorded, every axis
/// limit over every sample, vibration bounds.
/// @param task  the result's own
ProgramResultCheck verify_program_result(const ProgramResult& result, const Task& task);

/// Whether a commanded path is the program's: every programmed point passed in order and on straight lines in between,
/// no feed above the programmed one, no tolerance wider, every stop and dwell kept. Empty if so, else what is not.
std::string departs_from(const Toolpath& commanded, const Toolpath& programmed);

}  // namespace accdec
