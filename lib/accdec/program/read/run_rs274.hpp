#pragma once

#include <filesystem>
#include <string>

namespace accdec {

/// Runs a program through LinuxCNC's interpreter, `rs274 -g`, which knows parameters, expressions, O words, cycles and
/// offsets, and returns the canonical calls it prints (see read_canonical); their coordinates have four decimals.
/// @param tool_table  LinuxCNC's, or empty
/// @throws std::invalid_argument  if rs274 is not installed, saying how to install it, refuses the program, or
///                                the tool table is not there
std::string interpreted(const std::filesystem::path& program, const std::filesystem::path& tool_table);

}  // namespace accdec
