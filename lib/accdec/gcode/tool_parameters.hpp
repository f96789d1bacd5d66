#pragma once

#include <string>
#include <string_view>

#include <accdec/simulate.hpp>

namespace accdec {

/// Refuses programs that read lengths or diameters of tools as parameters, #5401 to #5413. If there is no table, rs274
/// has tools of its own. It gives these parameters in inch, also to programs in mm. Indirect reads (##1, #[5400+3]) are
/// recognised by the number itself, which stands in the program.
/// @throws ReadError  unless a tool table in inch is given
void refuse_tool_parameters(const std::string& program, std::string_view text, const ProgramTools& tools);

}  // namespace accdec
