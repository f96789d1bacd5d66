#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <accdec/plan/record/program_record.hpp>

namespace accdec {

/// The differences found between a recorded result and one made again.
struct ProgramDifferences {
  std::vector<std::string> reasons;  ///< at most ten, in the order of the file
  std::vector<std::string> skipped;  ///< members of the result that were not compared
};

/// Compares a program's result, of any schema, with the record of `found`. It lists numbers that differ by more than
/// relative 1e-9 and absolute 1e-13, other words, and missing or unknown members. Members that say how the plan was
/// found or what other plans take are not compared; only their types must be right. Bounds on such times are checked.
/// @param text    of the result, valid JSON
/// @param record  read from it
/// @param found   its `cycle_time_kept`, if any, is the longest that may be recorded
/// @param skip    further members not to compare, because the program was not read again
ProgramDifferences program_differences(std::string_view text, const ProgramRecord& record, const ProgramResult& found,
                                       const std::vector<std::string>& skip);

}  // namespace accdec
