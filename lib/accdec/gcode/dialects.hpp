#pragma once

#include <string>
#include <string_view>

namespace accdec {

/// The meaning of a word of a line that neither accdec nor LinuxCNC reads, with the dialect that has it: FANUC,
/// HEIDENHAIN, Mach, GRBL or a printer's firmware. Empty if the line has no such word that is known here.
std::string foreign_words(std::string_view line);

}  // namespace accdec
