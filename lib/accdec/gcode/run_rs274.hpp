#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include <accdec/files.hpp>
#include <accdec/simulate.hpp>

namespace accdec {

/// Reads a program through LinuxCNC's interpreter, `rs274 -g`, which knows parameters, expressions, O words, cycles and
/// offsets. It prints canonical calls (see gcode/read_formats.hpp) whose coordinates have four decimals. Lines of the
/// path and of messages are those of the program. Blocks deleted by / are left out, as by our own reader.
/// @param deadline  ends it, but not before ten seconds
/// @throws std::invalid_argument  if rs274 is not installed, saying how to install it, or refuses the program, or does
///                                not end; if a length or diameter of a tool is needed and no tool table is given or
///                                there
/// @throws ReadError              as read_toolpath and refuse_tool_parameters
Toolpath read_interpreted(const std::filesystem::path& program, const ProgramTools& tools, const Machine& machine,
                          const ToolpathOptions& options, const Deadline& deadline = {});

/// The message for a program whose G43 on a line takes a tool length that nobody gave; it names the options that do.
/// @param line  0 in a subroutine that has a file of its own, whose lines rs274 does not number
std::string no_tool_length(const std::string& program, std::int64_t line);

/// The program with the number of every line as its N word, of `line_number_digits` digits. Lines that do nothing,
/// lines with O words and lines too long for it stay as they are. Splines have lines beside them, see
/// lines_with_spline.
std::string numbered_lines(std::string_view text);

}  // namespace accdec
