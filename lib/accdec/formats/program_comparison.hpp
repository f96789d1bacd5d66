#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <accdec/program/write/program_report.hpp>

namespace accdec {

/// What comparing a recorded result with one made anew found.
struct ProgramDifferences {
  std::vector<std::string> reasons;  ///< at most ten, in the order of the file
  std::vector<std::string> skipped;  ///< members that the result has and nobody compared
};

/// What a program's result, accdec.program/1, records otherwise than `found` would be recorded: numbers that differ by
/// more than relative 1e-9 and absolute 1e-13, other words, members that are missing or unknown. Members that say how
/// the plan was found or what other plans take are not compared; of these only the kind of value counts.
/// @param text  of the result, valid JSON
/// @param skip  further members not to compare, because the program was not read again
ProgramDifferences program_differences(std::string_view text, const ProgramResult& found,
                                       const std::vector<std::string>& skip);

}  // namespace accdec
