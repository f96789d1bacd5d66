#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <accdec/program/write/program_report.hpp>

namespace accdec {

/// Members of a program's result that say how it was found or what other plans take: a recheck cannot find them from
/// the commands. All others are compared.
const std::vector<std::string>& program_members_not_checked();

/// What a program's result, accdec.program/1, records otherwise than `found` would be recorded: numbers that differ by
/// more than relative 1e-9 and absolute 1e-13, other words, members that are missing or unknown. At most
/// ten, in the order of the file.
/// @param text  of the result, valid JSON
/// @param skip  further members not to compare, because the program was not read again
std::vector<std::string> program_differences(std::string_view text, const ProgramResult& found,
                                             const std::vector<std::string>& skip);

}  // namespace accdec
